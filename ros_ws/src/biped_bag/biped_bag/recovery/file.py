"""Hand everything that is whole in one damaged file on to the recovered bag."""

from __future__ import annotations

import mmap
from dataclasses import dataclass, field
from pathlib import Path

from mcap.records import (
    Attachment,
    Channel,
    DataEnd,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    Schema,
)

from biped_bag.recovery.report import RecoveryReport
from biped_bag.recovery.scan import Hole, WholeChunk, scan
from biped_bag.recovery.tally import FileTally
from biped_bag.storage.contents import BagTopic, message_of, topic_of
from biped_bag.storage.integrity import (
    DamagedFileError,
    FileEnd,
    UnusableFileError,
    data_match,
    file_end,
)
from biped_bag.storage.metadata import OWN_RECORD
from biped_bag.storage.writer import BagWriter


@dataclass
class RecoveredBag:
    """The bag that a recovery writes, and the report that grows with it."""

    report: RecoveryReport
    writer: BagWriter
    _topics: set[str] = field(default_factory=set)
    _records: list[Metadata] = field(default_factory=list)

    def add_topic(self, topic: BagTopic) -> None:
        """Make a topic known to the new bag, once."""
        if topic.name not in self._topics:
            self._topics.add(topic.name)
            self.writer.add_topic(topic)
            self.report.topic(topic.name)

    def add_record(self, record: Metadata) -> None:
        """Hand on a metadata record; every file of a bag repeats those of the run."""
        if record.name != OWN_RECORD and record not in self._records:
            self._records.append(record)
            self.writer.add_record(record.name, record.metadata)


class FileRecovery:
    """One file of a broken bag."""

    def __init__(self, whole: RecoveredBag, file: Path, content: mmap.mmap) -> None:
        """Prepare.

        Args:
            whole: takes what is recovered.
            file: to recover.
            content: of the file.
        """
        self._whole = whole
        self._file = file
        self._content = content
        self._tally = FileTally()
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._known: set[int] = set()
        self._sound = 0
        self._holes = 0
        self._ended = False

    def run(self, told_end_ns: int) -> None:
        """Recover the file.

        Args:
            told_end_ns: its last log time as metadata.yaml says, or 0.

        Raises:
            UnusableFileError: it is not MCAP.
            BagError: the new bag cannot be written.
        """
        end = self._end()
        for found in scan(self._content, end.data_end_at if end else None):
            if isinstance(found, Hole):
                self._add_hole(found)
                continue
            self._sound += 1
            if not isinstance(found, MessageIndex):
                self._tally.settle()
            if isinstance(found, WholeChunk):
                for record in found.records:
                    self._add(record)
                self._whole.writer.flush()
            else:
                self._add(found)
        if not self._sound:
            raise UnusableFileError(f"{self._file}: not an MCAP file, or all damaged")
        self._finish(end, told_end_ns)

    def _end(self) -> FileEnd | None:
        try:
            end = file_end(self._file, self._content)
        except DamagedFileError:
            return None
        if end.summary is not None:
            self._schemas.update(end.summary.schemas)
            self._channels.update(end.summary.channels)
        return end

    def _add(self, record: McapRecord) -> None:
        if isinstance(record, Message):
            self._add_message(record)
        elif isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
            self._topic_of(record.id)
        elif isinstance(record, MessageIndex):
            self._tally.add_index(record)
        elif isinstance(record, Metadata):
            self._whole.add_record(record)
        elif isinstance(record, Attachment):
            self._whole.writer.attach(record)
        elif isinstance(record, DataEnd):
            self._ended = True

    def _add_message(self, message: Message) -> None:
        topic = self._topic_of(message.channel_id)
        if topic is None:
            self._tally.channel(message.channel_id).add_hole(1, message.log_time)
            return
        self._tally.add(message)
        self._whole.writer.write(message_of(topic, message))

    def _add_hole(self, hole: Hole) -> None:
        self._holes += 1
        self._whole.report.damage.append(
            f"{self._file}: bytes {hole.at} to {hole.end} ({hole.what})"
        )
        if hole.may_hold_messages:
            self._tally.add_hole(hole.end_ns)

    def _topic_of(self, channel_id: int) -> str | None:
        """Return the name of a channel's topic, which the new bag knows from now on."""
        channel = self._channels.get(channel_id)
        schema = self._schemas.get(channel.schema_id) if channel else None
        if channel is None or schema is None:
            return None
        if channel_id not in self._known:
            self._known.add(channel_id)
            self._whole.add_topic(topic_of(channel, schema))
        return channel.topic

    def _finish(self, end: FileEnd | None, told_end_ns: int) -> None:
        report = self._whole.report
        statistics = end.summary.statistics if end and end.summary else None
        if statistics is not None:
            self._tally.finish(
                statistics.message_end_time, statistics.channel_message_counts
            )
        else:
            if told_end_ns > self._tally.last_ns:
                self._tally.add_hole(told_end_ns)
            self._tally.finish(0, None)
        for number, tally in self._tally.channels.items():
            channel = self._channels.get(number)
            name = channel.topic if channel else f"channel {number} (definition lost)"
            report.topic(name).add(tally.loss)
        report.end_known = report.end_known and (end is not None or self._ended)
        damaged = (
            end is not None and end.data_crc and not data_match(self._content, end)
        )
        if damaged and not self._holes:
            report.damage.append(
                f"{self._file}: a byte outside of all messages; what the bag says of "
                "its run may be wrong"
            )
