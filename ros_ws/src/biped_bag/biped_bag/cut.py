"""Cut a stretch out of a bag: by time, or by episodes.

What is kept: the messages of the stretch with their times; the last message that each
latched topic had before it, which then stands at its start; the `biped.run` record; the
`biped.episode` records of walks that end in it; attachments, if it begins with the bag,
since they say what the run began with.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from biped_bag.errors import BagError
from biped_bag.records import EPISODE_RECORD, RUN_RECORD
from biped_bag.storage.contents import BagMessage
from biped_bag.storage.layout import refuse_existing
from biped_bag.storage.reader import BagReader
from biped_bag.storage.writer import new_bag
from biped_common.timing import NS_PER_S

_MESSAGES_PER_FLUSH = 1000


@dataclass(frozen=True)
class Stretch:
    """A stretch of a bag, by log time."""

    start_ns: int
    end_ns: int
    """The first moment after it."""


@dataclass(frozen=True)
class Cut:
    """What a cut came to."""

    messages: int
    """Of the stretch."""
    latched: int
    """From before it."""


def stretch_of_time(
    bag: BagReader, start_s: float | None, end_s: float | None
) -> Stretch:
    """Return the stretch between two times, in seconds from the bag's first message.

    Raises:
        BagError: it holds nothing of the bag.
    """
    start = 0 if start_s is None else round(start_s * NS_PER_S)
    end = bag.duration_ns + 1 if end_s is None else round(end_s * NS_PER_S)
    if not 0 <= start < end or start > bag.duration_ns:
        raise BagError(
            f"{bag.path}: from {1e-9 * start:g} s to {1e-9 * end:g} s: must lie within "
            f"the bag's {1e-9 * bag.duration_ns:.3f} s, and end after it starts"
        )
    return Stretch(bag.start_ns + start, bag.start_ns + end)


def stretch_of_episodes(bag: BagReader, first: int, last: int) -> Stretch:
    """Return the stretch from one episode's start to the same or another one's end.

    Raises:
        BagError: the bag has no such episodes.
    """
    starts: list[int] = []
    ends: list[int] = []
    numbers: list[int] = []
    before_ns = bag.start_ns
    for record in bag.records(EPISODE_RECORD):
        try:
            number = int(record.metadata["episode"])
            end_ns = int(record.metadata["last_log_time"])
            start_ns = int(record.metadata["first_log_time"] or before_ns)
        except (KeyError, ValueError):
            raise BagError(
                f"{bag.path}: an {EPISODE_RECORD} record has no episode, "
                "first_log_time or last_log_time"
            ) from None
        numbers.append(number)
        if first <= number <= last:
            starts.append(start_ns)
            ends.append(end_ns)
        before_ns = end_ns
    if not starts:
        there = f"{min(numbers)} to {max(numbers)}" if numbers else "none"
        raise BagError(
            f"{bag.path}: has no finished episode from {first} to {last}; "
            f"there: {there}"
        )
    return Stretch(min(starts), max(ends) + 1)


def cut(
    bag: BagReader, out: Path, stretch: Stretch, topics: Collection[str] | None = None
) -> Cut:
    """Write a stretch of a bag as a bag of its own.

    Args:
        bag: to cut.
        out: folder of the new bag; must not exist.
        stretch: to keep.
        topics: to keep; None keeps all.

    Raises:
        BagError: a topic is not in the bag, or the output cannot be written.
    """
    kept = bag.chosen(topics)
    refuse_existing(out)
    latched = _latched_before(bag, kept, stretch.start_ns)
    count = 0
    with new_bag(out) as writer:
        for record in bag.records():
            if record.name == RUN_RECORD or (
                record.name == EPISODE_RECORD and _ends_in(record.metadata, stretch)
            ):
                writer.add_record(record.name, record.metadata)
        if stretch.start_ns <= bag.start_ns:
            for item in bag.attachments():
                writer.attach(item)
        for name in kept:
            writer.add_topic(bag.topics[name])
        for message in latched:
            writer.write(message._replace(log_ns=stretch.start_ns))
        for message in bag.messages(kept, stretch.start_ns, stretch.end_ns):
            writer.write(message)
            count += 1
            if count % _MESSAGES_PER_FLUSH == 0:
                writer.flush()
        writer.close({"cut_from": bag.path.name})
    return Cut(count, len(latched))


def _latched_before(
    bag: BagReader, topics: Collection[str], start_ns: int
) -> list[BagMessage]:
    """Return the last message of each latched topic before a time, in their order."""
    names = [name for name in topics if bag.topics[name].latched]
    last: dict[str, BagMessage] = {}
    if names:
        for message in bag.messages(names, end_ns=start_ns):
            last[message.topic] = message
    return sorted(last.values(), key=lambda message: message.log_ns)


def _ends_in(episode: dict[str, str], stretch: Stretch) -> bool:
    try:
        return stretch.start_ns < int(episode["last_log_time"]) < stretch.end_ns
    except (KeyError, ValueError):
        return False
