"""Everything that stands in the data of an MCAP file, met one record after the other.

For files without checksums of data and summary, as other recorders write them: every
chunk is unpacked, every message counted, and the summary must tell the same. It also
finds messages that stand outside of chunks, which no summary has an index of.
"""

from __future__ import annotations

from collections import Counter

from mcap.opcode import Opcode
from mcap.records import Channel, McapRecord, Message, Schema, Statistics

from biped_bag.storage.mcap_record import (
    MOST_CHUNK_BYTES,
    Content,
    DamagedRecordError,
    Place,
    attachment_matches,
    parsed,
    places,
    records_in,
    stored_chunk,
    unpacked,
)
from biped_bag.storage.summary import Block, Summary, check_sizes

_BLOCK_BYTES = min(2**20, MOST_CHUNK_BYTES)


class DataWalk:
    """What the data of a file hold."""

    def __init__(self, content: Content, at: int, end: int) -> None:
        """Walk through a stretch of records.

        Raises:
            DamagedRecordError: one does not hold together.
        """
        self.blocks: list[Block] = []
        """Chunks and stretches of messages outside of chunks, as they stand."""
        self._chunks: list[Block] = []
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._counts: Counter[int] = Counter()
        self._first_ns = self._last_ns = 0
        self._text_bytes = 0
        for place in places(content, at, end):
            try:
                self._meet(content, place)
            except DamagedRecordError as error:
                raise DamagedRecordError(f"byte {place.at}: {error}") from None

    def disagreement(self, summary: Summary) -> str | None:
        """Return what a summary tells that is not so, or None."""
        told = summary.statistics
        for name, ours, theirs in (
            ("a definition", self._schemas, summary.schemas),
            ("a topic", self._channels, summary.channels),
        ):
            if any(ours.get(key) != value for key, value in theirs.items()):
                return name
        if summary.chunks and sorted(summary.chunks) != sorted(self._chunks):
            return "where chunks are"
        return None if told is None or self._agrees(told) else "how many messages"

    def _agrees(self, told: Statistics) -> bool:
        counts = {key: n for key, n in told.channel_message_counts.items() if n}
        held = self._counts.total()
        times = (told.message_start_time, told.message_end_time)
        return (
            told.message_count == held
            and counts in ({}, self._counts)
            and (not held or times == (self._first_ns, self._last_ns))
        )

    def _meet(self, content: Content, place: Place) -> None:
        body = bytes(content[place.body : place.end])
        if place.opcode == Opcode.CHUNK:
            chunk = stored_chunk(body, 0)
            if chunk.data_at + chunk.data_bytes != len(body):
                raise DamagedRecordError("a chunk with lengths that do not agree")
            for held in records_in(unpacked(chunk, body[chunk.data_at :])):
                self._count(held)
            block = Block(chunk.start_ns, place.at, place.end, chunk.end_ns)
            self._chunks.append(block)
            self.blocks.append(block)
            return
        if place.opcode == Opcode.ATTACHMENT and not attachment_matches(body):
            raise DamagedRecordError("an attachment that does not match its checksum")
        record = parsed(place.opcode, body)
        self._count(record)
        if isinstance(record, Message):
            self._extend(place, record.log_time)

    def _count(self, record: McapRecord | None) -> None:
        if isinstance(record, Message):
            if record.channel_id not in self._channels:
                raise DamagedRecordError(
                    f"a message of channel {record.channel_id}, which nothing tells of"
                )
            first = not self._counts
            self._counts[record.channel_id] += 1
            at_ns = record.log_time
            self._first_ns = at_ns if first else min(self._first_ns, at_ns)
            self._last_ns = max(self._last_ns, at_ns)
        elif isinstance(record, Schema):
            self._text_bytes += len(record.data) * (record.id not in self._schemas)
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._channels[record.id] = record
        check_sizes(0, self._text_bytes)

    def _extend(self, place: Place, log_ns: int) -> None:
        """Add a message to the last stretch, or begin a new one."""
        last = self.blocks[-1] if self.blocks else None
        if last and last.end == place.at and place.end - last.at <= _BLOCK_BYTES:
            self.blocks[-1] = Block(
                min(last.start_ns, log_ns), last.at, place.end, max(last.end_ns, log_ns)
            )
        else:
            self.blocks.append(Block(log_ns, place.at, place.end, log_ns))
