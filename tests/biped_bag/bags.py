"""Bags to read, cut, damage and mend."""

import contextlib
from pathlib import Path

from mcap.exceptions import EndOfFile
from mcap.records import Attachment, Message
from mcap.stream_reader import StreamReader

from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.writer import BagWriter
from biped_description.joints import JOINT_NAMES
from biped_ros.cdr import string_message
from biped_ros.messages import clock_template, joint_state_template
from msgs_json import topics

START_NS = 1_700_000_000_000_000_000
TICK_NS = 2_000_000
_FOREVER = {"sec": 9223372036, "nsec": 854775807}
RELIABLE = {
    "history": "keep_last",
    "depth": 1000,
    "reliability": "reliable",
    "durability": "volatile",
    "deadline": _FOREVER,
    "lifespan": _FOREVER,
    "liveliness": "automatic",
    "liveliness_lease_duration": _FOREVER,
    "avoid_ros_namespace_conventions": False,
}
LATCHED = RELIABLE | {"depth": 1, "durability": "transient_local"}
FAST = (topics.CLOCK, topics.JOINT_STATES)
SLOW = (topics.ROBOT_DESCRIPTION,)
TICKS_PER_FLUSH = 50  # as the recorder flushes, every 0.1 s


def control_tick(tick: int) -> list[BagMessage]:
    """What the 500 Hz topics say at a control tick; no two messages are alike."""
    at_ns = START_NS + tick * TICK_NS
    positions = [tick * 1e-3 + joint for joint in range(len(JOINT_NAMES))]
    values = (*positions, *(2 * p for p in positions), *(3 * p for p in positions))
    states = joint_state_template(JOINT_NAMES, with_effort=True).fill(values, tick)
    clock = clock_template().fill((), tick)
    return [
        BagMessage(topics.CLOCK.name, bytes(clock), at_ns, at_ns - 5, tick + 1),
        BagMessage(
            topics.JOINT_STATES.name, bytes(states), at_ns + 7, at_ns - 3, tick + 1
        ),
    ]


def robot_description() -> BagMessage:
    """The latched message with which recordings start."""
    message = string_message("<robot name='biped'/>")
    name = topics.ROBOT_DESCRIPTION.name
    return BagMessage(name, message, START_NS, START_NS - 100, 1)


def record(
    folder: Path,
    ticks: int = 600,
    episode_ticks: int = 0,
    attachment: bytes = b"",
    **options: int,
) -> list[BagMessage]:
    """Write a bag; return its messages.

    Args:
        folder: of the bag.
        ticks: control ticks to record.
        episode_ticks: write a `biped.episode` record after so many; 0 writes none.
        attachment: content of `memory.npz`, if any.
        options: of BagWriter.
    """
    writer = BagWriter(
        folder, records={"biped.run": {"seed": "7", "preset": "quick"}}, **options
    )
    for topic in (*FAST, *SLOW):
        qos = LATCHED if topic.latched else RELIABLE
        writer.add_topic(BagTopic(topic.name, topic.type_name, [qos]))
    if attachment:
        writer.attach(memory(attachment))
    messages = [robot_description()]
    writer.write(messages[0])
    for tick in range(ticks):
        messages += control_tick(tick)
        for message in messages[-2:]:
            writer.write(message)
        if (tick + 1) % TICKS_PER_FLUSH == 0:
            writer.flush()
    writer.close()
    return messages


def memory(content: bytes) -> Attachment:
    """The attachment of a learner's memory."""
    kind = "application/octet-stream"
    return Attachment(START_NS, START_NS, "memory.npz", kind, content)


def messages_to_the_end(file: Path) -> list[Message]:
    """Messages of a file that was not finished, up to its last complete chunk."""
    messages = []
    with file.open("rb") as content, contextlib.suppress(EndOfFile):
        for record in StreamReader(content).records:
            if isinstance(record, Message):
                messages.append(record)
    return messages
