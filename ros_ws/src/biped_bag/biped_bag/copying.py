"""Make a new bag out of another one: all of it or nothing."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterator
from pathlib import Path

from biped_bag.errors import BagError
from biped_bag.reader import BagMessage, BagTopic, offered_qos
from biped_bag.writer import MESSAGE_ENCODING, BagWriter, RecordedMessage

OWN_RECORD = "rosbag2"
"""Metadata record that every writer writes itself, about its own bag."""


def refuse_existing(out: Path) -> None:
    """Return if a new bag can be made there.

    Raises:
        BagError: something is there already.
    """
    if out.exists() or out.is_symlink():
        raise BagError(f"{out}: is there already, and is never overwritten")


@contextlib.contextmanager
def new_bag(out: Path) -> Iterator[BagWriter]:
    """Write a bag that is gone again when the block fails; the block closes it.

    Raises:
        BagError: it cannot be written there.
    """
    writer = BagWriter(out)
    try:
        yield writer
    except BaseException:
        with contextlib.suppress(BagError):
            writer.close()
        shutil.rmtree(out, ignore_errors=True)
        raise


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
