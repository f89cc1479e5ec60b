"""What of a damaged MCAP file can be trusted, record by record.

a chunk counts whole or not at all: it must unpack to the bytes of its checksum. One
    of its two lengths may be wrong; the other one serves.
a damaged chunk is passed over by its length. Its message index, which stands behind
    it, still tells how many messages it held.
where a length leads nowhere, the next record that holds together is searched for,
    byte by byte; what lies between is a hole.
an attachment must match its checksum; other records have none, and are taken when
    all their lengths agree.
"""

from __future__ import annotations

import mmap
import re
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from io import BytesIO

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    DataEnd,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    Schema,
)
from mcap.stream_reader import breakup_chunk
from mcap.writer import MCAP0_MAGIC as MAGIC

from biped_bag.storage.integrity import DAMAGE, RECORD_HEADER

# Before its data a chunk has times, size, CRC, name of the compression, length of data.
_CHUNK_TIMES = struct.Struct("<QQ")
_CHUNK_FIXED = struct.Struct("<QQQII")
_LENGTH = struct.Struct("<Q")
_CRC_SIZE = 4
_LARGEST_CHUNK = 2**31  # unpacked bytes; a damaged size must not take all memory
# The beginning of a record that a search may stop at: none is longer than 2**40 bytes.
# Looked for ahead, since what only seems to be one may overlap one that is.
_BEGINNING = re.compile(
    rb"(?=[\x06\x07\x09\x0c].{5}\x00{3}|\x0f\x04\x00{7})", flags=re.DOTALL
)
_READERS: dict[int, Callable[[ReadDataStream], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.MESSAGE_INDEX: MessageIndex.read,
    Opcode.METADATA: Metadata.read,
    Opcode.DATA_END: DataEnd.read,
}


@dataclass(frozen=True)
class WholeChunk:
    """The records of a chunk that matches its checksum."""

    records: list[McapRecord]


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


Found = McapRecord | WholeChunk | Hole


def scan(content: mmap.mmap, data_end_at: int | None) -> Iterator[Found]:
    """Yield records, whole chunks and holes, in the order of the file.

    Args:
        content: of the file.
        data_end_at: where its data end, if a sound end says so; by default at the
            record that ends them, or with the file.
    """
    size = len(content) if data_end_at is None else data_end_at
    at = len(MAGIC) if content[: len(MAGIC)] == MAGIC else 0
    chunked = False
    while at < size:
        found, end = _record_at(content, at, size)
        if isinstance(found, Message) and chunked:
            found = None  # messages stand in chunks, or all of them outside
        if found is None:
            end = _next_record(content, at + 1, size)
            found = Hole(at, end, *_torn_chunk(content, at))
        chunked = chunked or isinstance(found, WholeChunk)
        yield found
        if isinstance(found, DataEnd):
            return
        at = end


def _next_record(content: mmap.mmap, start: int, size: int) -> int:
    """Return where the next record that holds together begins, or the end."""
    for beginning in _BEGINNING.finditer(content, start, size):
        if _record_at(content, beginning.start(), size)[0] is not None:
            return beginning.start()
    return size


def _record_at(content: mmap.mmap, at: int, size: int) -> tuple[Found | None, int]:
    """Return the record at a position, if it holds together, and where it ends."""
    if at + RECORD_HEADER.size > size:
        return None, size
    opcode, length = RECORD_HEADER.unpack_from(content, at)
    body = at + RECORD_HEADER.size
    if opcode == Opcode.CHUNK:
        return _chunk_at(content, body, length, size)
    if body + length > size:
        return None, size
    end = body + length
    if opcode == Opcode.ATTACHMENT:
        return _attachment(content[body:end], at, end), end
    try:
        stream = ReadDataStream(BytesIO(content[body:end]))
        if opcode == Opcode.MESSAGE:
            return Message.read(stream, length), end
        record = _READERS[opcode](stream)
        return (record if stream.count == length else None), end
    except DAMAGE:
        return None, end


def _attachment(body: bytes, at: int, end: int) -> Attachment | Hole | None:
    try:
        stream = ReadDataStream(BytesIO(body))
        attachment: Attachment = Attachment.read(stream)
    except DAMAGE:
        return None
    if stream.count != len(body):
        return None
    (crc,) = struct.unpack("<I", body[-_CRC_SIZE:])
    if crc and zlib.crc32(body[:-_CRC_SIZE]) != crc:
        return Hole(at, end, f"attachment {attachment.name}", may_hold_messages=False)
    return attachment


def _chunk_at(
    content: mmap.mmap, body: int, length: int, size: int
) -> tuple[Found | None, int]:
    """Return a chunk, or the hole that it is, and where it ends."""
    try:
        start_ns, end_ns, unpacked, crc, name_size = _CHUNK_FIXED.unpack_from(
            content, body
        )
        name_at = body + _CHUNK_FIXED.size
        data_at = name_at + name_size + _LENGTH.size
        compression = content[name_at : name_at + name_size].decode()
        (data_size,) = _LENGTH.unpack_from(content, data_at - _LENGTH.size)
    except DAMAGE:
        return None, size
    by_record = body + length
    by_data = data_at + data_size
    for end in dict.fromkeys((by_data, by_record)):
        if not data_at <= end <= size:
            continue
        chunk = Chunk(
            compression, content[data_at:end], end_ns, start_ns, crc, unpacked
        )
        try:
            if _unpacked_size(chunk) <= _LARGEST_CHUNK:
                return WholeChunk(breakup_chunk(chunk, validate_crc=True)), end
        except DAMAGE:
            continue
    if by_record == by_data <= size:
        return Hole(body - RECORD_HEADER.size, by_data, "chunk", end_ns), by_data
    return None, size


def _unpacked_size(chunk: Chunk) -> int:
    if chunk.compression != "zstd":
        return len(chunk.data)
    return zstandard.get_frame_parameters(chunk.data).content_size


def _torn_chunk(content: mmap.mmap, at: int) -> tuple[str, int]:
    """Return what stood at a hole and, of a chunk, its last log time."""
    body = at + RECORD_HEADER.size
    if content[at] != Opcode.CHUNK or body + _CHUNK_TIMES.size > len(content):
        return "bytes", 0
    start_ns, end_ns = _CHUNK_TIMES.unpack_from(content, body)
    return "chunk", end_ns if start_ns <= end_ns else 0
