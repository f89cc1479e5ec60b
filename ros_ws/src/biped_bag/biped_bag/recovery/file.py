"""Hand everything that is whole in one damaged file on to the recovered bag."""

from __future__ import annotations

import hashlib
import mmap
from dataclasses import dataclass, field
from pathlib import Path

from mcap.records import Attachment, Channel, Message, Metadata, Schema

from biped_bag.errors import BagError
from biped_bag.recovery.report import RecoveryReport
from biped_bag.recovery.scan import End, Found, Hole, WholeChunk, scan
from biped_bag.recovery.tally import FileTally
from biped_bag.storage.contents import BagTopic, message_of, topic_of
from biped_bag.storage.integrity import (
    DamagedFileError,
    FileEnd,
    UnusableFileError,
    data_match,
    file_end,
)
from biped_bag.storage.mcap_record import ChannelIndex
from biped_bag.storage.metadata import OWN_RECORD
from biped_bag.storage.writer import BagWriter


@dataclass
class RecoveredBag:
    """The bag that a recovery writes, and the report that grows with it."""

    report: RecoveryReport
    writer: BagWriter
    _topics: set[str] = field(default_factory=set)
    _seen: dict[bytes, tuple[Path, int]] = field(default_factory=dict)

    def add_topic(self, topic: BagTopic) -> None:
        """Make a topic known to the new bag, once."""
        if topic.name not in self._topics:
            self._topics.add(topic.name)
            self.writer.add_topic(topic)
            self.report.topic(topic.name)

    def add_record(self, record: Metadata) -> None:
        """Hand on a metadata record; every file of a bag repeats those of the run."""
        content = repr((record.name, sorted(record.metadata.items()))).encode()
        if record.name != OWN_RECORD and self.seen_before(content, Path()) is None:
            self.writer.add_record(record.name, record.metadata)

    def seen_before(
        self, content: bytes, file: Path, at: int = 0
    ) -> tuple[Path, int] | None:
        """Return in which file and where the same content stood before, if it did."""
        digest = hashlib.blake2b(content, digest_size=16).digest()
        before = self._seen.get(digest)
        self._seen.setdefault(digest, (file, at))
        return before


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
        self._names: dict[int, str | None] = {}
        self._records = 0
        self._holes = 0
        self._data_end: End | None = None

    def run(self, told_end_ns: int) -> None:
        """Recover the file.

        Args:
            told_end_ns: its last log time as metadata.yaml says, or 0.

        Raises:
            UnusableFileError: it is not MCAP.
            BagError: the new bag cannot be written.
        """
        end = self._end()
        whole = end is not None and self._matches(end.data_end_at, end.data_crc)
        for found in scan(self._content, end.data_end_at if end else None):
            if isinstance(found, WholeChunk):
                found = self._copy_of_another(found, whole) or found
            if isinstance(found, Hole):
                self._add_hole(found)
                continue
            self._records += 1
            if not isinstance(found, ChannelIndex):
                self._tally.settle()
            if isinstance(found, WholeChunk):
                for record in found.records:
                    self._add(record)
                self._whole.writer.flush()
            else:
                self._add(found)
        if not self._records:
            raise UnusableFileError(f"{self._file}: not an MCAP file, or all damaged")
        self._finish(end, whole, told_end_ns)

    def _end(self) -> FileEnd | None:
        """Return the end of the file, if a checksum vouches for it."""
        try:
            end = file_end(self._file, self._content)
        except DamagedFileError:
            return None
        if end.summary is None or not end.summary_crc:
            return None
        self._schemas.update(end.summary.schemas)
        self._channels.update(end.summary.channels)
        return end

    def _matches(self, data_end_at: int, crc: int) -> bool:
        return crc != 0 and data_match(self._content, data_end_at, crc)

    def _copy_of_another(self, chunk: WholeChunk, whole: bool) -> Hole | None:
        """Return the hole that a chunk is which has been recovered already.

        A file may be whole and still hold a chunk twice: then both were recorded.
        """
        if not any(isinstance(record, Message) for record in chunk.records):
            return None  # every file of a bag begins with the same definitions
        before = self._whole.seen_before(chunk.data, self._file, chunk.at)
        if before is None or (whole and before[0] == self._file):
            return None
        what = f"a copy of the chunk at byte {before[1]} of {before[0].name}"
        return Hole(chunk.at, chunk.end, what, may_hold_messages=False)

    def _add(self, record: Found | Schema | Channel | Message) -> None:
        if isinstance(record, Message):
            self._add_message(record)
        elif isinstance(record, Schema):
            if self._schemas.get(record.id) != record:
                self._names.clear()
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            if self._channels.get(record.id) != record:
                self._names.pop(record.id, None)
            self._channels[record.id] = record
            self._topic_of(record.id)
        elif isinstance(record, ChannelIndex):
            self._tally.add_index(record)
        elif isinstance(record, Metadata):
            self._whole.add_record(record)
        elif isinstance(record, Attachment):
            self._add_attachment(record)
        elif isinstance(record, End):
            self._data_end = record

    def _add_message(self, message: Message) -> None:
        topic = self._topic_of(message.channel_id)
        if topic is None:
            self._tally.channel(message.channel_id).add_hole(1, message.log_time)
            return
        self._tally.add(message)
        self._whole.writer.write(message_of(topic, message))

    def _add_attachment(self, item: Attachment) -> None:
        content = repr((item.name, item.log_time)).encode() + item.data
        if self._whole.seen_before(content, Path()) is None:
            self._whole.writer.attach(item)

    def _add_hole(self, hole: Hole) -> None:
        self._holes += 1
        self._whole.report.damage.append(
            f"{self._file}: bytes {hole.at} to {hole.end} ({hole.what})"
        )
        if hole.may_hold_messages:
            self._tally.add_hole(hole.end_ns)

    def _topic_of(self, channel_id: int) -> str | None:
        """Return the name of a channel's topic, which the new bag knows from now on.

        None where its definition is lost, or is none that can be written.
        """
        if channel_id not in self._names:
            channel = self._channels.get(channel_id)
            schema = self._schemas.get(channel.schema_id) if channel else None
            self._names[channel_id] = None
            if channel is not None and schema is not None:
                try:
                    self._whole.add_topic(topic_of(channel, schema))
                    self._names[channel_id] = channel.topic
                except BagError as error:
                    self._whole.report.damage.append(f"{self._file}: {error}")
        return self._names[channel_id]

    def _finish(self, end: FileEnd | None, whole: bool, told_end_ns: int) -> None:
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
        data_end = End(end.data_end_at, end.data_crc) if end else self._data_end
        report.end_known = report.end_known and data_end is not None
        if data_end is None or not data_end.crc or whole or self._holes:
            return
        if not self._matches(data_end.at, data_end.crc):
            report.damage.append(
                f"{self._file}: a byte outside of all messages; what the bag says of "
                "its run may be wrong"
            )
