"""The summary at an MCAP file's end: what the file holds, and where.

Only as much is kept of it as is used: a long recording has a chunk every 64 KiB.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import NamedTuple

from mcap.opcode import Opcode
from mcap.records import Channel, Schema, Statistics

from biped_bag.storage.mcap_record import (
    Content,
    DamagedRecordError,
    Place,
    parsed,
    places,
)

MOST_SUMMARY_BYTES = 64 * 2**20
"""Of all files of a bag: about 300,000 chunks, which is 20 GB of our recorder's."""
MOST_TEXT_BYTES = 16 * 2**20
"""Of that, names and definitions of topics."""

_CHUNK_INDEX = struct.Struct("<QQQQ")  # times, place and length of the chunk, ...
_RECORD_INDEX = struct.Struct("<QQ")  # place and length of the record, ...


class Block(NamedTuple):
    """A stretch of a file that holds messages: a chunk, or messages in none."""

    start_ns: int
    """No log time is before."""
    at: int
    end: int
    end_ns: int
    """No log time is behind."""


@dataclass
class Summary:
    """What a summary tells."""

    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    statistics: Statistics | None = None
    chunks: list[Block] = field(default_factory=list)
    attachments: list[tuple[int, int]] = field(default_factory=list)
    """Begin and end of each."""
    metadata: list[tuple[int, int]] = field(default_factory=list)
    size: int = 0
    """Bytes of all this in the file."""
    text_size: int = 0
    """Bytes of the schemas and channels."""


def read_summary(content: Content, at: int, end: int) -> Summary:
    """Return the summary in a stretch of a file.

    Raises:
        DamagedRecordError: it is none, or larger than any that is read.
    """
    check_sizes(end - at, 0)
    summary = Summary(size=end - at)
    for place in places(content, at, end):
        try:
            _take(summary, place, bytes(content[place.body : place.end]))
        except struct.error:
            raise DamagedRecordError(f"byte {place.at}: cut off") from None
    return summary


def check_sizes(size: int, text_size: int) -> None:
    """Refuse summaries that would take more memory than there should be.

    Raises:
        DamagedRecordError: more bytes, or more bytes of texts, than are read.
    """
    for told, most, what in (
        (size, MOST_SUMMARY_BYTES, "summary"),
        (text_size, MOST_TEXT_BYTES, "definitions of topics"),
    ):
        if told > most:
            raise DamagedRecordError(f"{told} bytes of {what}, {most} at most")


def _take(summary: Summary, place: Place, body: bytes) -> None:
    if place.opcode == Opcode.CHUNK_INDEX:
        start_ns, end_ns, at, length = _CHUNK_INDEX.unpack_from(body)
        summary.chunks.append(Block(start_ns, at, at + length, end_ns))
        return
    if place.opcode in (Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX):
        at, length = _RECORD_INDEX.unpack_from(body)
        attached = place.opcode == Opcode.ATTACHMENT_INDEX
        where = summary.attachments if attached else summary.metadata
        where.append((at, at + length))
        return
    record = parsed(place.opcode, body)
    if isinstance(record, Statistics):
        summary.statistics = record
    elif isinstance(record, Schema | Channel):
        summary.text_size += len(body)
        check_sizes(0, summary.text_size)
        if isinstance(record, Schema):
            summary.schemas[record.id] = record
        else:
            summary.channels[record.id] = record
