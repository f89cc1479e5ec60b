"""Hand topics and messages of one bag on to the writer of another."""

from __future__ import annotations

from biped_bringup.bag.errors import BagError
from biped_bringup.bag.reader import BagMessage, BagTopic, offered_qos
from biped_bringup.bag.writer import MESSAGE_ENCODING, BagWriter, RecordedMessage

OWN_RECORD = "rosbag2"
"""Metadata record that every writer writes itself, about its own bag."""


def add_topic(writer: BagWriter, topic: BagTopic) -> None:
    """Make a topic known to a writer, with the definition that the other bag has.

    Raises:
        BagError: its messages are not CDR.
    """
    if topic.encoding != MESSAGE_ENCODING:
        raise BagError(
            f"{topic.name}: messages are encoded as {topic.encoding or 'nothing'}, "
            f"but must be {MESSAGE_ENCODING}"
        )
    writer.add_topic(
        topic.name,
        topic.type_name,
        offered_qos(topic.qos),
        type_hash=topic.type_hash,
        definition=topic.definition,
    )


def recorded(message: BagMessage) -> RecordedMessage:
    """Return a message as a writer takes it."""
    return RecordedMessage(
        message.topic,
        message.data,
        message.log_time_ns,
        message.publish_time_ns,
        message.sequence,
    )
