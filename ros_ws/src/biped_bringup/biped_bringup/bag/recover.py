"""Rewrite a broken bag into a sound one, and say exactly what was lost.

What is recovered:
    all messages of all chunks that are whole, in their order, with their times and
        numbers; topics with types, QoS and definitions; metadata records; attachments.
    Nothing else: a message of a damaged chunk cannot be told from noise.
What failures do:
    the file ends anywhere: everything before its last, torn record is recovered.
    bytes are damaged: the record that they are in is lost, all others are recovered,
        also where the damage hides how long the record was.
    the definition of a topic is lost (it stands in the first chunk and in the summary):
        messages of the topic count as lost.
    metadata.yaml is missing, damaged or out of date: the files are taken as they are.
    all is damaged, or a file is not MCAP: `RecoveryFailedError`, nothing is written.
    the output cannot be written: the same; what was begun is removed.
    the output is there already: `BagError`, it is never overwritten.
The broken bag is never changed.
How losses are counted, see `losses`; a finished `metadata.yaml` counts, too. Without an
end, messages that the recorder had not yet handed to the system (at most 0.1 s) leave
no trace: the report says that the end is missing.
"""

from __future__ import annotations

import mmap
from dataclasses import dataclass, field
from pathlib import Path

from mcap.reader import SeekingReader
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
from mcap.summary import Summary

from biped_bringup.bag.bag_files import data_files
from biped_bringup.bag.copying import OWN_RECORD, add_topic, new_bag, refuse_existing
from biped_bringup.bag.errors import BagError
from biped_bringup.bag.losses import FileTally
from biped_bringup.bag.mcap_check import (
    MAGIC,
    DamagedFileError,
    FileEnd,
    data_match,
    file_end,
    mapped,
)
from biped_bringup.bag.mcap_scan import Hole, WholeChunk, scan
from biped_bringup.bag.metadata import BagMetadata, read_metadata
from biped_bringup.bag.reader import BagTopic, bag_topic
from biped_bringup.bag.recovery_report import RecoveryReport, TopicRecovery
from biped_bringup.bag.writer import BagWriter, RecordedMessage


class RecoveryFailedError(BagError):
    """Nothing could be recovered, or what was could not be written."""


def recover(bag: Path, out: Path) -> RecoveryReport:
    """Rewrite a broken bag.

    Args:
        bag: folder of a bag, with or without metadata.yaml, or a single MCAP file.
        out: folder of the bag to write; must not exist.

    Raises:
        RecoveryFailedError: there is nothing to recover, or no place for it.
        BagError: no such bag, or the output is there already.
    """
    if not bag.exists():
        raise BagError(f"{bag}: no such file or folder")
    refuse_existing(out)
    if bag.resolve() in out.resolve().parents:
        raise BagError(f"{out}: must not be inside the broken bag")
    report = RecoveryReport(str(bag), str(out))
    try:
        files = data_files(bag) if bag.is_dir() else (bag,)
        with new_bag(out) as writer:
            recovery = _Recovery(report, writer, _metadata(bag))
            for file in files:
                recovery.add_file(file)
            recovery.compare(files)
            if not report.recovered and not report.nothing_lost:
                raise BagError(f"{bag}: holds no message that is whole")
            written = writer.metadata
            report.duration_s = 1e-9 * (written.end_ns - written.start_ns)
            writer.close({"recovered_from": bag.name})
    except BagError as error:
        raise RecoveryFailedError(str(error)) from None
    return report


def _metadata(bag: Path) -> BagMetadata | None:
    try:
        return read_metadata(bag) if bag.is_dir() else None
    except BagError:
        return None


@dataclass
class _Recovery:
    """All that is found, on its way into the new bag."""

    report: RecoveryReport
    writer: BagWriter
    told: BagMetadata | None
    """What metadata.yaml says, as of the bag's end or its last split."""
    _topics: dict[str, BagTopic] = field(default_factory=dict)
    _records: list[Metadata] = field(default_factory=list)
    _last_file: int = 0

    def add_file(self, file: Path) -> None:
        """Recover what is in a file.

        Raises:
            BagError: it is not MCAP.
        """
        with mapped(file) as content:
            before = self.report.recovered
            _FileRecovery(self, file, content).run()
            self._last_file = self.report.recovered - before

    def add_topic(self, topic: BagTopic) -> None:
        """Make a topic known to the new bag, once."""
        if topic.name not in self._topics:
            add_topic(self.writer, topic)
            self._topics[topic.name] = topic
            self.topic(topic.name)

    def add_record(self, record: Metadata) -> None:
        """Hand on a metadata record; every file of a bag repeats those of the run."""
        if record.name != OWN_RECORD and record not in self._records:
            self._records.append(record)
            self.writer.add_record(record.name, record.metadata)

    def topic(self, name: str) -> TopicRecovery:
        """Return the report of a topic."""
        return self.report.topics.setdefault(name, TopicRecovery())

    def told_end_ns(self, file: Path) -> int:
        """Return the last log time of a file as metadata.yaml says, or 0."""
        files = self.told.files if self.told else ()
        return max((info.end_ns for info in files if info.path == file.name), default=0)

    def compare(self, files: tuple[Path, ...]) -> None:
        """Take the counts of metadata.yaml, if it was written when the bag ended."""
        if self.told is None or not self.told.files:
            return
        names = {file.name for file in files}
        for info in self.told.files:
            if info.path not in names:
                lost_s = 1e-9 * (info.end_ns - info.start_ns)
                self.report.damage.append(f"{info.path}: is missing, {lost_s:.3f} s")
        last = self.told.files[-1]
        # At its last split, all that the last file held was latched, and of one moment.
        finished = last.end_ns > last.start_ns and last.message_count >= self._last_file
        if not finished:
            return
        self.report.end_known = True
        for told in self.told.topics:
            topic = self.topic(told.name)
            topic.lost = max(0, told.message_count - topic.recovered)
            topic.exact = True
            topic.lost_s = topic.lost_s if topic.lost else 0.0


class _FileRecovery:
    """One file of a broken bag."""

    def __init__(self, whole: _Recovery, file: Path, content: mmap.mmap) -> None:
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

    def run(self) -> None:
        """Recover the file."""
        end, summary = self._end()
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
            raise BagError(f"{self._file}: not an MCAP file, or all damaged")
        self._finish(end, summary)

    def _end(self) -> tuple[FileEnd | None, Summary | None]:
        try:
            end = file_end(self._content)
        except DamagedFileError:
            return None, None
        self._content.seek(0)
        reader = SeekingReader(self._content)  # type: ignore[arg-type]
        summary = reader.get_summary() if self._content[:8] == MAGIC else None
        if summary is not None:
            self._schemas.update(summary.schemas)
            self._channels.update(summary.channels)
        return end, summary

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
            self._whole.writer.attach(
                record.name, record.media_type, record.data, record.log_time
            )
        elif isinstance(record, DataEnd):
            self._ended = True

    def _add_message(self, message: Message) -> None:
        topic = self._topic_of(message.channel_id)
        if topic is None:
            self._tally.channel(message.channel_id).add_hole(1, message.log_time)
            return
        self._tally.add(message)
        self._whole.writer.write(
            RecordedMessage(
                topic,
                message.data,
                message.log_time,
                message.publish_time,
                message.sequence,
            )
        )

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
            self._whole.add_topic(bag_topic(channel, schema, 0))
        return channel.topic

    def _finish(self, end: FileEnd | None, summary: Summary | None) -> None:
        report = self._whole.report
        totals, end_ns = None, 0
        if summary is not None and summary.statistics is not None:
            end_ns = summary.statistics.message_end_time
            totals = summary.statistics.channel_message_counts
        elif self._whole.told_end_ns(self._file) > self._tally.last_ns:
            self._tally.add_hole(self._whole.told_end_ns(self._file))
        self._tally.finish(end_ns, totals)
        for number, tally in self._tally.channels.items():
            channel = self._channels.get(number)
            name = channel.topic if channel else f"channel {number} (definition lost)"
            topic = self._whole.topic(name)
            topic.recovered += tally.recovered
            topic.lost += tally.lost
            topic.exact = topic.exact and tally.exact
            topic.lost_s += 1e-9 * tally.lost_ns
        report.end_known = report.end_known and (end is not None or self._ended)
        damaged = (
            end is not None and end.data_crc and not data_match(self._content, end)
        )
        if damaged and not self._holes:
            report.damage.append(
                f"{self._file}: a byte outside of all messages; what the bag says of "
                "its run may be wrong"
            )
