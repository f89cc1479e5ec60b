"""What was received, written and lost, topic by topic: in the bag, and for people."""

from __future__ import annotations

import json
from collections.abc import Iterable

from biped_bag.recorder.intake import IncomingTopic
from biped_bag.writer import BagWriter


def counts(topic: IncomingTopic, bag: BagWriter) -> dict[str, int]:
    """Return the counts of one topic.

    `received` is what came, `written` what is in the bag of it, `lost` what its
    publishers sent in between and did not come, `earlier` what they had sent before
    the recorder was connected to them, and `repeated` latched messages written again
    at the start of a further file.
    """
    repeated = bag.repeated.get(topic.name, 0)
    in_bag = {info.name: info.message_count for info in bag.metadata.topics}
    return {
        "received": topic.received,
        "written": in_bag.get(topic.name, 0) - repeated,
        "lost": topic.continuity.lost,
        "earlier": topic.continuity.earlier,
        "repeated": repeated,
    }


def counts_record(topics: Iterable[IncomingTopic], bag: BagWriter) -> dict[str, str]:
    """Return the counts of all topics as MCAP metadata: JSON by topic."""
    return {t.name: json.dumps(counts(t, bag)) for t in topics if t.announced}


def counts_table(topics: Iterable[IncomingTopic], bag: BagWriter) -> list[str]:
    """Return one line per topic and one for all."""
    rows = [(topic.name, counts(topic, bag)) for topic in topics if topic.announced]
    lines = [
        f"{name}: {n['received']} received, {n['written']} written, {n['lost']} lost"
        for name, n in sorted(rows)
    ]
    written, lost = (sum(n[key] for _, n in rows) for key in ("written", "lost"))
    return [*lines, f"{bag.folder}: {written} messages written, {lost} lost"]
