"""Which recorded messages are played, in which order, and when, in log time.

Latched topics come first, as a subscriber that joins a running graph would find them:
the last messages before the start, or else the topic's first one, brought forward.
"""

from __future__ import annotations

import struct
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

from biped_bag.storage.contents import BagMessage
from biped_common.timing import NS_PER_S
from msgs_json.topics import CLOCK

_CLOCK = struct.Struct("<4sII")
_ENCAPSULATION = b"\0\1\0\0"

Read = Callable[[Collection[str], int | None, int | None], Iterable[BagMessage]]
"""Gives the messages of topics from a log time to another (exclusive), in order."""


def scheduled(
    read: Read,
    topics: Collection[str],
    latched: Mapping[str, int],
    start_ns: int,
    end_ns: int,
) -> Iterator[BagMessage]:
    """Yield the messages to play.

    Args:
        read: of the bag.
        topics: to be played.
        latched: those among them that are latched, with their depth.
        start_ns: log time of the start.
        end_ns: log time at which playing ends, exclusive.
    """
    kept = {topic: deque[BagMessage](maxlen=n) for topic, n in latched.items()}
    if kept:
        for message in read(kept, None, start_ns):
            kept[message.topic].append(message)
    forward = {topic for topic, messages in kept.items() if not messages}
    if forward:
        missing = set(forward)
        for message in read(forward, start_ns, end_ns):
            if message.topic in missing:
                kept[message.topic].append(message)
                missing.remove(message.topic)
            if not missing:
                break
    for messages in kept.values():
        for message in messages:
            yield message._replace(log_ns=start_ns)
    for message in read(topics, start_ns, end_ns):
        if message.topic in forward:
            forward.remove(message.topic)
        else:
            yield message


def with_clock(
    messages: Iterable[BagMessage],
    start_ns: int,
    end_ns: int,
    period_ns: int,
) -> Iterator[BagMessage]:
    """Yield the messages with the log time on /clock in between, from start to end."""
    tick_ns = start_ns
    for message in messages:
        while tick_ns <= message.log_ns:
            yield clock_message(tick_ns)
            tick_ns += period_ns
        yield message
    while tick_ns < end_ns:
        yield clock_message(tick_ns)
        tick_ns += period_ns


def clock_message(log_ns: int) -> BagMessage:
    """Return a rosgraph_msgs/Clock of a log time."""
    data = _CLOCK.pack(_ENCAPSULATION, *divmod(log_ns, NS_PER_S))
    return BagMessage(CLOCK.name, data, log_ns, log_ns)
