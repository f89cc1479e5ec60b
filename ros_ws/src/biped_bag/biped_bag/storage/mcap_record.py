"""One record of an MCAP file, out of bytes that nobody vouches for.

The MCAP library believes every length that it reads, and unpacks whatever a chunk
holds. Here each length is held against the bytes that are there and against a bound
before anything is made of them: a damaged or a hostile record costs no more memory than
a large sound one. What does not hold together is a `DamagedRecordError`.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from collections.abc import Callable, Iterator
from io import BytesIO
from typing import NamedTuple

import lz4.frame  # type: ignore[import-untyped]
import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    Channel,
    DataEnd,
    Header,
    McapRecord,
    Message,
    Metadata,
    Schema,
    Statistics,
)

_MIB = 2**20
MOST_CHUNK_BYTES = 32 * _MIB
"""Unpacked, and as it is stored. Our recorder's have 64 KiB and a message."""
MOST_ATTACHMENT_BYTES = 65 * _MIB
"""The largest memory of a learner, and its name."""
_MOST_TEXT_BYTES = 4 * _MIB  # what most others hold: names, definitions, settings

RECORD_HEADER = struct.Struct("<BQ")  # opcode, length of what follows
_MESSAGE = struct.Struct("<HIQQ")  # channel, number, log and publish time, then data
_INDEX = struct.Struct("<HI")  # channel, bytes of the pairs of log time and offset
_PAIR_BYTES = 16
_CRC = struct.Struct("<I")
# Before its data a chunk has times, size, CRC, name of the compression, length of data.
_CHUNK_FIXED = struct.Struct("<QQQII")
_LENGTH = struct.Struct("<Q")

_MOST_BYTES = {
    Opcode.CHUNK: MOST_CHUNK_BYTES,
    Opcode.MESSAGE: MOST_CHUNK_BYTES,
    Opcode.MESSAGE_INDEX: MOST_CHUNK_BYTES,
    Opcode.ATTACHMENT: MOST_ATTACHMENT_BYTES,
}
_READERS: dict[int, Callable[[ReadDataStream], McapRecord]] = {
    Opcode.HEADER: Header.read,
    Opcode.SCHEMA: Schema.read,
    Opcode.CHANNEL: Channel.read,
    Opcode.STATISTICS: Statistics.read,
    Opcode.ATTACHMENT: Attachment.read,
    Opcode.METADATA: Metadata.read,
    Opcode.DATA_END: DataEnd.read,
}
# What the libraries raise on bytes that are none of theirs; lz4 has RuntimeErrors only.
_DAMAGE = (
    McapError,
    zstandard.ZstdError,
    struct.error,
    RuntimeError,
    ValueError,
    LookupError,
    OverflowError,
    MemoryError,
)

Content = bytes | mmap.mmap
"""Bytes that slices can be taken of."""


class DamagedRecordError(Exception):
    """Bytes that are not the record which they seem to be; the text says why."""


class Place(NamedTuple):
    """Where a record stands."""

    opcode: int
    at: int
    """Of its first byte."""
    body: int
    """Of the first byte behind opcode and length."""
    end: int


class StoredChunk(NamedTuple):
    """A chunk as it stands in the file; the library's copies the data."""

    start_ns: int
    end_ns: int
    unpacked_bytes: int
    crc: int
    compression: str
    data_at: int
    data_bytes: int


class ChannelIndex(NamedTuple):
    """What the message index of a chunk says of one channel."""

    channel_id: int
    messages: int
    first_ns: int
    """Smallest log time, 0 without messages."""
    last_ns: int


def place_of(content: Content, at: int, stop: int) -> Place:
    """Return where the record that begins at a position stands.

    Args:
        content: of the file.
        at: position.
        stop: the record must end here or before.

    Raises:
        DamagedRecordError: it does not fit, or is larger than any that is read.
    """
    if at + RECORD_HEADER.size > stop:
        raise DamagedRecordError(f"byte {at}: cut off")
    opcode, length = RECORD_HEADER.unpack_from(content, at)
    body = at + RECORD_HEADER.size
    if body + length > stop:
        raise DamagedRecordError(f"byte {at}: a record of {length} bytes does not fit")
    most = _MOST_BYTES.get(opcode, _MOST_TEXT_BYTES)
    if length > most:
        raise DamagedRecordError(
            f"byte {at}: a record of {length} bytes, of this kind {most} at most"
        )
    return Place(opcode, at, body, body + length)


def places(content: Content, at: int, stop: int) -> Iterator[Place]:
    """Yield where the records of a stretch stand, one after the other.

    Raises:
        DamagedRecordError: they do not fill the stretch.
    """
    while at < stop:
        place = place_of(content, at, stop)
        yield place
        at = place.end


def parsed(opcode: int, body: bytes) -> McapRecord | None:
    """Return a record, None if it is of a kind that is not read as a whole.

    Raises:
        DamagedRecordError: the bytes are none of this kind.
    """
    if opcode == Opcode.MESSAGE:
        return _message(body)
    read = _READERS.get(opcode)
    if read is None:
        return None
    try:
        stream = ReadDataStream(BytesIO(body))
        record = read(stream)
    except _DAMAGE as error:
        raise _damaged(error) from None
    if stream.count != len(body):
        raise DamagedRecordError("lengths that do not agree")
    return record


def attachment_matches(body: bytes) -> bool:
    """Return whether an attachment, given as its bytes, matches its checksum."""
    (crc,) = _CRC.unpack(body[-_CRC.size :])
    return not crc or zlib.crc32(body[: -_CRC.size]) == crc


def channel_index(body: bytes) -> ChannelIndex:
    """Return a record of a message index.

    Raises:
        DamagedRecordError: the bytes are none.
    """
    if len(body) < _INDEX.size:
        raise DamagedRecordError("a message index that is cut off")
    channel_id, size = _INDEX.unpack_from(body)
    if size != len(body) - _INDEX.size or size % _PAIR_BYTES:
        raise DamagedRecordError("a message index with lengths that do not agree")
    times = np.frombuffer(body, dtype="<u8", offset=_INDEX.size)[::2]
    ends = (int(times.min()), int(times.max())) if len(times) else (0, 0)
    return ChannelIndex(channel_id, len(times), *ends)


def stored_chunk(content: Content, body: int) -> StoredChunk:
    """Return the chunk whose body begins at a position, without its data.

    Raises:
        DamagedRecordError: it is cut off within its head.
    """
    try:
        start_ns, end_ns, unpacked_bytes, crc, name_bytes = _CHUNK_FIXED.unpack_from(
            content, body
        )
        name_at = body + _CHUNK_FIXED.size
        name = bytes(content[name_at : name_at + min(name_bytes, _PAIR_BYTES)]).decode()
        (data_bytes,) = _LENGTH.unpack_from(content, name_at + name_bytes)
    except _DAMAGE as error:
        raise _damaged(error) from None
    data_at = name_at + name_bytes + _LENGTH.size
    return StoredChunk(start_ns, end_ns, unpacked_bytes, crc, name, data_at, data_bytes)


def unpacked(chunk: StoredChunk, data: bytes) -> bytes:
    """Return what the data of a chunk unpack to.

    Raises:
        DamagedRecordError: not to the bytes of the checksum, to more than is read, or
            in a way that is not known.
    """
    try:
        content = _UNPACK[chunk.compression](data, chunk.unpacked_bytes)
    except KeyError:
        raise DamagedRecordError(
            f"compression {chunk.compression!r} is not known"
        ) from None
    except _DAMAGE as error:
        raise _damaged(error) from None
    whole = (
        zlib.crc32(content) == chunk.crc
        if chunk.crc
        else len(content) == chunk.unpacked_bytes
    )
    if not whole:
        raise DamagedRecordError("a chunk that does not match its checksum")
    return content


def records_in(data: bytes) -> Iterator[Schema | Channel | Message]:
    """Yield the records of an unpacked chunk, or of a stretch of messages.

    Raises:
        DamagedRecordError: the bytes are not such records, one after the other.
    """
    for opcode, _, body, end in places(data, 0, len(data)):
        if opcode in (Opcode.MESSAGE, Opcode.SCHEMA, Opcode.CHANNEL):
            record = parsed(opcode, data[body:end])
            assert isinstance(record, Schema | Channel | Message)
            yield record


def _message(body: bytes) -> Message:
    if len(body) < _MESSAGE.size:
        raise DamagedRecordError("a message that is cut off")
    channel_id, sequence, log_ns, publish_ns = _MESSAGE.unpack_from(body)
    return Message(channel_id, log_ns, body[_MESSAGE.size :], publish_ns, sequence)


def _as_it_is(data: bytes, _: int) -> bytes:
    return data


def _of_zstd(data: bytes, told_bytes: int) -> bytes:
    # The library makes room for what the frame tells, or else for what it is told.
    size = zstandard.get_frame_parameters(data).content_size
    if size == zstandard.CONTENTSIZE_UNKNOWN:
        size = told_bytes
    if size > MOST_CHUNK_BYTES:
        raise _too_large(size)
    # What stands behind a frame is the next record, where a damaged length says more.
    return zstandard.ZstdDecompressor().decompress(
        data, max_output_size=size, allow_extra_data=False
    )


def _of_lz4(data: bytes, _: int) -> bytes:
    unpack = lz4.frame.LZ4FrameDecompressor()
    content: bytes = unpack.decompress(data, max_length=MOST_CHUNK_BYTES + 1)
    if len(content) > MOST_CHUNK_BYTES:
        raise _too_large(len(content))
    if not unpack.eof:
        raise ValueError("lz4 data that are cut off")
    if unpack.unused_data:
        raise ValueError("more behind lz4 data than there can be")
    return content


_UNPACK: dict[str, Callable[[bytes, int], bytes]] = {
    "": _as_it_is,
    "zstd": _of_zstd,
    "lz4": _of_lz4,
}


def _too_large(size: int) -> ValueError:
    return ValueError(
        f"a chunk of {size} bytes or more, {MOST_CHUNK_BYTES} bytes at most"
    )


def _damaged(error: Exception) -> DamagedRecordError:
    return DamagedRecordError(" ".join(str(error).split()) or type(error).__name__)
