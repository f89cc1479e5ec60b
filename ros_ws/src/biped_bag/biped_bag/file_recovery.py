"""Hand everything that is whole in one damaged file on to the recovered bag."""

from __future__ import annotations

import mmap
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

from biped_bag.losses import FileTally
from biped_bag.mcap_check import (
    MAGIC,
    DamagedFileError,
    FileEnd,
    UnusableFileError,
    data_match,
    file_end,
)
from biped_bag.mcap_scan import Hole, WholeChunk, scan
from biped_bag.reader import bag_topic
from biped_bag.recovered_bag import RecoveredBag
from biped_bag.writer import RecordedMessage


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

    def run(self) -> None:
        """Recover the file.

        Raises:
            UnusableFileError: it is not MCAP.
            BagError: the new bag cannot be written.
        """
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
            raise UnusableFileError(f"{self._file}: not an MCAP file, or all damaged")
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
