"""Is an MCAP file whole? Every byte of it is covered by some checksum.

A file that ends with its footer and carries a checksum of its data section (all that we
write do) is judged by that, without unpacking anything. Other recorders leave it out;
then every chunk is unpacked and compared with its own checksum.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import zstandard
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Statistics
from mcap.stream_reader import StreamReader
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC as MAGIC

from biped_bag.errors import BagError

RECORD_HEADER = struct.Struct("<BQ")  # opcode, length of what follows
_DATA_END = struct.Struct("<BQI")  # ..., CRC-32 of all bytes before
_FOOTER = struct.Struct("<BQQQI")  # ..., start of summary, of its offsets, CRC-32
_CRC_SIZE = 4

# What reading a damaged file can raise: the library checks lengths and types nowhere.
DAMAGE = (
    McapError,
    zstandard.ZstdError,
    struct.error,
    ValueError,
    LookupError,
    OverflowError,
    MemoryError,
    StopIteration,
)


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


def sound_summary(file: Path) -> tuple[Summary, Statistics]:
    """Return what a file's end tells of it, once all of it is found whole.

    Raises:
        UnusableFileError: not an MCAP file at all, or it cannot be read.
        DamagedFileError: an MCAP file without its end, or with damaged bytes.
    """
    with mapped(file) as content:
        if content[: len(MAGIC)] != MAGIC:
            raise UnusableFileError(f"{file}: not an MCAP file")
        end = file_end(file, content)
        if end.data_crc and not data_match(content, end):
            raise DamagedFileError(f"{file}: some of its bytes are damaged")
        if not end.data_crc:
            _check_chunks(file, content)
    if end.summary is None or end.summary.statistics is None:
        raise DamagedFileError(f"{file}: it has no summary")
    return end.summary, end.summary.statistics


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
    ) or not len(MAGIC) <= data_end_at < footer_at:
        raise DamagedFileError(f"{file}: its footer is damaged")
    # The checksum covers the summary and the footer up to the checksum itself.
    covered = content[summary_at : footer_at + _FOOTER.size - _CRC_SIZE]
    if summary_crc and zlib.crc32(covered) != summary_crc:
        raise DamagedFileError(f"{file}: its summary is damaged")
    opcode, length, data_crc = _DATA_END.unpack_from(content, data_end_at)
    if (opcode, length) != (Opcode.DATA_END, _CRC_SIZE):
        raise DamagedFileError(f"{file}: the end of its data is damaged")
    return FileEnd(data_end_at, data_crc, _summary(file, content))


def data_match(content: mmap.mmap, end: FileEnd) -> bool:
    """Return whether the data are those whose checksum the end holds."""
    with memoryview(content) as view, view[: end.data_end_at] as data:
        return zlib.crc32(data) == end.data_crc


def _summary(file: Path, content: mmap.mmap) -> Summary | None:
    if content[: len(MAGIC)] != MAGIC:
        return None  # the library reads no such file
    content.seek(0)
    try:
        return SeekingReader(content).get_summary()  # type: ignore[arg-type]
    except DAMAGE as error:  # no checksum told
        raise DamagedFileError(f"{file}: its summary is damaged ({error})") from None


def _check_chunks(file: Path, content: mmap.mmap) -> None:
    content.seek(0)
    try:
        for _ in StreamReader(content, validate_crcs=True).records:  # type: ignore[arg-type]
            pass
    except DAMAGE as error:
        raise DamagedFileError(
            f"{file}: some of its bytes are damaged ({error})"
        ) from None
