"""What was received, written and lost, topic by topic: in the bag, and for people.

`received` is what came, `written` what is in the bag of it (not what came while the
recorder was paused, or before simulated time), `lost` what its publishers
sent in between and did not come, `earlier` what they had sent before the recorder was
connected to them, and `repeated` latched messages written again at the start of a
further file.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from biped_bag.recorder.intake import IncomingTopic
from biped_bag.storage.writer import BagWriter


def counts_of(
    topics: Iterable[IncomingTopic], bag: BagWriter
) -> dict[str, dict[str, int]]:
    """Return the counts of each topic that is in the bag."""
    in_bag = {topic.name: topic.count for topic in bag.metadata.topics}
    return {
        topic.name: {
            "received": topic.received,
            "written": in_bag.get(topic.name, 0) - bag.repeated[topic.name],
            "lost": topic.continuity.lost,
            "earlier": topic.continuity.earlier,
            "repeated": bag.repeated[topic.name],
        }
        for topic in topics
        if topic.announced
    }


def counts_table(counts: dict[str, dict[str, int]], folder: Path) -> list[str]:
    """Return one line per topic of which something was lost, and one for all."""
    lines = [
        f"{name}: {n['received']} received, {n['written']} written, {n['lost']} lost"
        for name, n in sorted(counts.items())
        if n["lost"]
    ]
    written = sum(n["written"] for n in counts.values())
    lost = sum(n["lost"] for n in counts.values())
    return [*lines, f"{folder}: {written} messages written, {lost} lost"]
