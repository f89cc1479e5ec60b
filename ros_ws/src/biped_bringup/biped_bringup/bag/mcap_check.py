"""Is an MCAP file whole? Every byte of it is covered by some checksum or comparison.

A file that ends with its footer and carries a checksum of its data section (all that we
write do) is judged by that, without unpacking anything. Other recorders leave it out;
then every chunk is unpacked and compared with its own checksum.
"""

from __future__ import annotations

import mmap
import struct
import zlib
from pathlib import Path

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import DataEnd, Footer
from mcap.stream_reader import StreamReader

from biped_bringup.bag.errors import BagError

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEADER = struct.Struct("<BQ")  # opcode, length
_DATA_END_SIZE = RECORD_HEADER.size + 4
_FOOTER_SIZE = RECORD_HEADER.size + 20
_TAIL_SIZE = _FOOTER_SIZE + len(MAGIC)

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


class DamagedFileError(Exception):
    """An MCAP file that is not whole; the text says how this shows."""


def check_file(file: Path) -> None:
    """Return if the file is whole.

    Raises:
        BagError: not an MCAP file at all, or it cannot be read.
        DamagedFileError: an MCAP file without its end, or with damaged bytes.
    """
    try:
        with file.open("rb") as stream:
            if not is_mcap(stream.read(len(MAGIC)), file):
                raise BagError(f"{file}: not an MCAP file")
            with mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as content:
                _check(content)
    except OSError as error:
        raise BagError(f"{file}: cannot be read ({error.strerror})") from None


def is_mcap(beginning: bytes, file: Path) -> bool:
    """Return whether a file begins, or was about to begin, as an MCAP file.

    Raises:
        BagError: it is empty.
    """
    if not beginning:
        raise BagError(f"{file}: empty, nothing was recorded")
    return beginning == MAGIC[: len(beginning)] and len(beginning) == len(MAGIC)


def _check(content: mmap.mmap) -> None:
    if len(content) < len(MAGIC) + _TAIL_SIZE or content[-len(MAGIC) :] != MAGIC:
        raise DamagedFileError("cut off, its end is missing")
    footer_at = len(content) - _TAIL_SIZE
    opcode, length = RECORD_HEADER.unpack_from(content, footer_at)
    if (opcode, length) != (Opcode.FOOTER, 20):
        raise DamagedFileError("its footer is damaged")
    content.seek(footer_at + RECORD_HEADER.size)
    footer = Footer.read(ReadDataStream(content))  # type: ignore[arg-type]
    summary_at = footer.summary_start or footer_at
    data_end_at = summary_at - _DATA_END_SIZE
    if not len(MAGIC) <= data_end_at < footer_at:
        raise DamagedFileError("its footer is damaged")
    # The checksum covers the summary and the footer up to the checksum itself.
    summary = content[summary_at : len(content) - len(MAGIC) - 4]
    if footer.summary_crc and zlib.crc32(summary) != footer.summary_crc:
        raise DamagedFileError("its summary is damaged")
    if content[data_end_at : data_end_at + 9] != RECORD_HEADER.pack(Opcode.DATA_END, 4):
        raise DamagedFileError("the end of its data is damaged")
    content.seek(data_end_at + RECORD_HEADER.size)
    crc = DataEnd.read(ReadDataStream(content)).data_section_crc  # type: ignore[arg-type]
    with memoryview(content) as view:
        if crc and zlib.crc32(view[:data_end_at]) != crc:
            raise DamagedFileError("some of its bytes are damaged")
    if not crc:
        _check_chunks(content)


def _check_chunks(content: mmap.mmap) -> None:
    content.seek(0)
    try:
        for _ in StreamReader(content, validate_crcs=True).records:  # type: ignore[arg-type]
            pass
    except DAMAGE as error:
        raise DamagedFileError(f"some of its bytes are damaged ({error})") from None
