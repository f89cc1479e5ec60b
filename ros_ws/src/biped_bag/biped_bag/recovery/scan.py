"""What of a damaged MCAP file can be trusted, record by record.

a chunk counts whole or not at all: it must unpack to the bytes of its checksum. One
    of its two lengths may be wrong; the other one serves.
a damaged chunk is passed over by its length. Its message index, which stands behind
    it, still tells how many messages it held.
where a length leads nowhere, the next record that holds together is searched for,
    byte by byte; what lies between is a hole.
an attachment must match its checksum; other records have none, and are taken when
    all their lengths agree.
an end of the data behind which whole chunks follow is none: a copy of it, perhaps.
where more bytes have been looked at in vain than there are in many such files, the rest
    counts as damaged: beginnings that lead to nothing can be made by the thousand.
"""

from __future__ import annotations

import mmap
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass

from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    DataEnd,
    Header,
    Message,
    Metadata,
    Schema,
)
from mcap.writer import MCAP0_MAGIC as MAGIC

from biped_bag.storage.mcap_record import (
    MOST_CHUNK_BYTES,
    RECORD_HEADER,
    ChannelIndex,
    DamagedRecordError,
    attachment_matches,
    channel_index,
    parsed,
    place_of,
    records_in,
    stored_chunk,
    unpacked,
)

_CHUNK_TIMES = struct.Struct("<QQ")
# The beginning of a record that a search may stop at: none is longer than 2**40 bytes.
# Looked for ahead, since what only seems to be one may overlap one that is.
_BEGINNING = re.compile(
    rb"(?=[\x06\x07\x09\x0c].{5}\x00{3}|\x0f\x04\x00{7})", flags=re.DOTALL
)
_CHUNK_BEGINNING = re.compile(rb"(?=\x06.{5}\x00{3})", flags=re.DOTALL)
_IN_VAIN_BYTES, _IN_VAIN_FILES = 2**28, 4

Definition = Header | Schema | Channel | Metadata | Attachment


@dataclass(frozen=True)
class WholeChunk:
    """A chunk that matches its checksum."""

    at: int
    end: int
    data: bytes
    """Unpacked."""

    @property
    def records(self) -> Iterator[Schema | Channel | Message]:
        """What it holds."""
        return records_in(self.data)


@dataclass(frozen=True)
class End:
    """The end of the data."""

    at: int
    crc: int
    """CRC-32 of all bytes before; 0 if the recorder took none."""


@dataclass(frozen=True)
class Hole:
    """A stretch of the file that is not what was written."""

    at: int
    end: int
    what: str
    """For people: what stood there, as far as it can be told."""
    end_ns: int = 0
    """Last log time of the chunk that stood there; 0 if not known."""
    may_hold_messages: bool = True


Found = Definition | Message | ChannelIndex | WholeChunk | End | Hole


def scan(content: mmap.mmap, data_end_at: int | None) -> Iterator[Found]:
    """Yield records, whole chunks and holes, in the order of the file.

    Args:
        content: of the file.
        data_end_at: where its data end, if a sound end says so; by default at the
            record that ends them, or with the file.
    """
    size = len(content) if data_end_at is None else data_end_at
    yield from _Scan(content, size).run()


class _Scan:
    def __init__(self, content: mmap.mmap, size: int) -> None:
        self._content = content
        self._size = size
        self._in_vain = _IN_VAIN_BYTES + _IN_VAIN_FILES * size
        """Bytes that may still be looked at without finding a record there."""

    def run(self) -> Iterator[Found]:
        at = len(MAGIC) if self._content[: len(MAGIC)] == MAGIC else 0
        chunked = False
        while at < self._size:
            found, end = self._record_at(at)
            if isinstance(found, Message) and chunked:
                found = None  # messages stand in chunks, or all of them outside
            if isinstance(found, End):
                end = self._next_record(end, _CHUNK_BEGINNING)
                if end == self._size:
                    yield found
                    return
                found = Hole(at, end, "an end of the data before the end")
            if found is None:
                end = self._next_record(at + 1, _BEGINNING)
                found = Hole(at, end, *self._torn_chunk(at))
            chunked = chunked or isinstance(found, WholeChunk)
            yield found
            at = end

    def _next_record(self, start: int, beginnings: re.Pattern[bytes]) -> int:
        """Return where the next record that holds together begins, or the end."""
        for beginning in beginnings.finditer(self._content, start, self._size):
            if self._record_at(beginning.start())[0] is not None:
                return beginning.start()
            if self._in_vain < 0:
                break
        return self._size

    def _record_at(self, at: int) -> tuple[Found | None, int]:
        """Return the record at a position, if it holds together, and where it ends."""
        if self._content[at] == Opcode.CHUNK:
            return self._chunk_at(at)
        looked_at = RECORD_HEADER.size
        try:
            place = place_of(self._content, at, self._size)
            looked_at = place.end - at
            body = self._content[place.body : place.end]
            return _record(place.opcode, at, body, place.end), place.end
        except DamagedRecordError:
            self._in_vain -= looked_at
        return None, self._size

    def _chunk_at(self, at: int) -> tuple[Found | None, int]:
        """Return a chunk, or the hole that it is, and where it ends."""
        body = at + RECORD_HEADER.size
        try:
            _, length = RECORD_HEADER.unpack(self._content[at:body])
            chunk = stored_chunk(self._content, body)
        except (DamagedRecordError, struct.error):
            return None, self._size
        by_record = body + length
        by_data = chunk.data_at + chunk.data_bytes
        for end in dict.fromkeys((by_data, by_record)):
            if not chunk.data_at <= end <= self._size:
                continue
            if end - chunk.data_at > MOST_CHUNK_BYTES:
                continue
            try:
                data = unpacked(chunk, self._content[chunk.data_at : end])
                for _ in records_in(data):
                    pass
                return WholeChunk(at, end, data), end
            except DamagedRecordError:
                self._in_vain -= end - at + min(chunk.unpacked_bytes, MOST_CHUNK_BYTES)
        if by_record == by_data <= self._size:
            return Hole(at, by_data, "chunk", chunk.end_ns), by_data
        return None, self._size

    def _torn_chunk(self, at: int) -> tuple[str, int]:
        """Return what stood at a hole and, of a chunk, its last log time."""
        times_at = at + RECORD_HEADER.size
        torn = self._content[at] == Opcode.CHUNK
        if not torn or times_at + _CHUNK_TIMES.size > len(self._content):
            return "bytes", 0
        start_ns, end_ns = _CHUNK_TIMES.unpack_from(self._content, times_at)
        return "chunk", end_ns if start_ns <= end_ns else 0


def _record(opcode: int, at: int, body: bytes, end: int) -> Found:
    """Return a record that may stand between chunks.

    Raises:
        DamagedRecordError: it does not hold together, or is of another kind.
    """
    if opcode == Opcode.MESSAGE_INDEX:
        return channel_index(body)
    record = parsed(opcode, body)
    if isinstance(record, Attachment) and not attachment_matches(body):
        return Hole(at, end, f"attachment {record.name!r}", may_hold_messages=False)
    if isinstance(record, DataEnd):
        return End(at, record.data_section_crc)
    if isinstance(record, Definition | Message):
        return record
    raise DamagedRecordError(f"byte {at}: no record that stands among the data")
