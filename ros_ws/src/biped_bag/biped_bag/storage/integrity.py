"""Is an MCAP file whole? Every byte of it is covered by some checksum.

A file that ends with its footer and carries checksums of data and summary (all that we
write do) is judged by those, without unpacking anything. Other recorders leave them
out; then the data are walked through, and the summary must tell the same.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from mcap.opcode import Opcode
from mcap.records import Statistics
from mcap.writer import MCAP0_MAGIC as MAGIC

from biped_bag.errors import BagError
from biped_bag.storage.data_walk import DataWalk
from biped_bag.storage.mcap_record import RECORD_HEADER, DamagedRecordError
from biped_bag.storage.summary import MOST_SUMMARY_BYTES, Summary, read_summary

_DATA_END = struct.Struct("<BQI")  # ..., CRC-32 of all bytes before
_FOOTER = struct.Struct("<BQQQI")  # ..., start of summary, of its offsets, CRC-32
_CRC_SIZE = 4
_PIECE_BYTES = 2**20


class UnusableFileError(BagError):
    """Not an MCAP file at all, or it cannot be read."""


class DamagedFileError(BagError):
    """An MCAP file that is not whole; the text says how this shows."""


@dataclass(frozen=True)
class FileEnd:
    """What stands behind the data of a file that was finished, found sound."""

    data_end_at: int
    """Position of the record that ends the data."""
    data_crc: int
    """CRC-32 of everything before `data_end_at`; 0 if the recorder took none."""
    summary: Summary | None
    """None if the recorder wrote none."""
    summary_crc: int
    """CRC-32 of the summary, which matches; 0 if the recorder took none."""


@dataclass(frozen=True)
class SoundFile:
    """A file that was found whole."""

    summary: Summary
    statistics: Statistics


@contextmanager
def mapped(file: Path) -> Iterator[mmap.mmap]:
    """Map a file into memory, to read.

    Raises:
        UnusableFileError: it is empty or cannot be read.
    """
    try:
        with file.open("rb") as stream:
            if not stream.read(1):
                raise UnusableFileError(f"{file}: empty, nothing was recorded")
            with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
                yield content
    except OSError as error:
        raise UnusableFileError(f"{file}: cannot be read ({error.strerror})") from None


def sound_file(file: Path) -> SoundFile:
    """Return what a file's end tells of it, once all of it is found whole.

    Raises:
        UnusableFileError: not an MCAP file at all, or it cannot be read.
        DamagedFileError: an MCAP file without its end, or with damaged bytes.
    """
    with mapped(file) as content:
        if content[: len(MAGIC)] != MAGIC:
            raise UnusableFileError(f"{file}: not an MCAP file")
        end = file_end(file, content)
        summary = end.summary
        if end.data_crc and not data_match(content, end.data_end_at, end.data_crc):
            raise DamagedFileError(f"{file}: some of its bytes are damaged")
        if summary is None or summary.statistics is None:
            raise DamagedFileError(f"{file}: it has no summary")
        _check_summary(file, content, end, summary, summary.statistics)
    return SoundFile(summary, summary.statistics)


def file_end(file: Path, content: mmap.mmap) -> FileEnd:
    """Return the end of a finished file.

    Raises:
        DamagedFileError: it has none, or a damaged one.
    """
    footer_at = len(content) - len(MAGIC) - _FOOTER.size
    if footer_at < len(MAGIC) or content[-len(MAGIC) :] != MAGIC:
        raise DamagedFileError(f"{file}: cut off, its end is missing")
    opcode, length, summary_start, _, summary_crc = _FOOTER.unpack_from(
        content, footer_at
    )
    summary_at = summary_start or footer_at
    data_end_at = summary_at - _DATA_END.size
    if (opcode, length) != (
        Opcode.FOOTER,
        _FOOTER.size - RECORD_HEADER.size,
    ) or not len(MAGIC) <= data_end_at < summary_at <= footer_at:
        raise DamagedFileError(f"{file}: its footer is damaged")
    if footer_at - summary_at > MOST_SUMMARY_BYTES:
        raise DamagedFileError(
            f"{file}: a summary of {footer_at - summary_at} bytes, "
            f"{MOST_SUMMARY_BYTES} at most"
        )
    # The checksum covers the summary and the footer up to the checksum itself.
    covered = content[summary_at : footer_at + _FOOTER.size - _CRC_SIZE]
    if summary_crc and zlib.crc32(covered) != summary_crc:
        raise DamagedFileError(f"{file}: its summary is damaged")
    opcode, length, data_crc = _DATA_END.unpack_from(content, data_end_at)
    if (opcode, length) != (Opcode.DATA_END, _CRC_SIZE):
        raise DamagedFileError(f"{file}: the end of its data is damaged")
    try:
        summary = read_summary(covered, 0, footer_at - summary_at)
    except DamagedRecordError as error:
        raise DamagedFileError(f"{file}: its summary is damaged ({error})") from None
    return FileEnd(
        data_end_at, data_crc, summary if summary_start else None, summary_crc
    )


def data_match(content: mmap.mmap, data_end_at: int, data_crc: int) -> bool:
    """Return whether everything before the end of the data has this CRC-32."""
    crc = 0
    for at in range(0, data_end_at, _PIECE_BYTES):
        crc = zlib.crc32(content[at : min(at + _PIECE_BYTES, data_end_at)], crc)
    return crc == data_crc


def _check_summary(
    file: Path,
    content: mmap.mmap,
    end: FileEnd,
    summary: Summary,
    statistics: Statistics,
) -> None:
    """Refuse a summary that does not tell where the messages are, or not the truth.

    Messages outside of chunks are in no index; their places are added here.
    """
    indexed = summary.chunks or not statistics.message_count
    if not (end.data_crc and end.summary_crc and indexed):
        try:
            walk = DataWalk(content, len(MAGIC), end.data_end_at)
        except DamagedRecordError as error:
            raise DamagedFileError(
                f"{file}: some of its bytes are damaged ({error})"
            ) from None
        wrong = walk.disagreement(summary)
        if wrong is not None:
            raise DamagedFileError(f"{file}: its summary is damaged ({wrong})")
        summary.chunks = walk.blocks
    for at, stop in (
        *((block.at, block.end) for block in summary.chunks),
        *summary.attachments,
        *summary.metadata,
    ):
        if not len(MAGIC) <= at < stop <= end.data_end_at:
            raise DamagedFileError(
                f"{file}: its summary tells of a record at byte {at}, where none is"
            )
    for number in statistics.channel_message_counts:
        if number not in summary.channels:
            raise DamagedFileError(
                f"{file}: its summary counts messages of channel {number}, "
                "which it does not tell of"
            )
