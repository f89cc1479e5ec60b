"""One file that holds a run: arrays and a JSON header in a NumPy zip, no pickle.

What failures do:
    writing fails (disk full, folder gone): the previous file stays as it was.
    reading finds something else (foreign, truncated, damaged, another version, larger
    than any that is read): CheckpointError, one line that says what and where; nothing
    is taken over.
"""

from __future__ import annotations

import json
import os
import struct
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import IO, Any, NoReturn

import msgspec
import numpy as np
from numpy.typing import NDArray

from biped_common.atomic_file import atomic_file
from biped_common.errors import BipedError
from learner_node.memory import Arrays, arrays_sha256

FORMAT = "biped checkpoint"
VERSION = 2
MOST_BYTES = 64 * 2**20
"""Of a file; with 3,202 bytes a state, 20,000 states. A learned walk has 50."""
_HEADER = "header"
_KINDS = "biufU"  # of arrays: numbers, and the header's text
# The end of a zip: mark, ..., bytes of the directory, its place, bytes of the remark.
_ZIP_END = struct.Struct("<4s8xIIH")
_ZIP64_MARK, _ZIP64_BYTES = b"PK\6\7", 20
_MOST_DIRECTORY_BYTES = 2**16


class CheckpointError(BipedError, ValueError):
    """The file is no usable checkpoint; the message says why."""


def write_checkpoint(path: Path, header: dict[str, Any], arrays: Arrays) -> None:
    """Write a checkpoint atomically.

    Args:
        path: the file, conventionally `*.npz`.
        header: anything JSON can hold.
        arrays: numeric arrays by name.

    Raises:
        CheckpointError: it would be larger than any that is read again.
    """
    text = json.dumps(
        {
            "format": FORMAT,
            "version": VERSION,
            "arrays_sha256": arrays_sha256(arrays),
            **header,
        }
    )
    with atomic_file(path) as stream:
        np.savez(stream, allow_pickle=False, **{_HEADER: np.array(text)}, **arrays)
        _refuse_large(path, stream.tell())


def read_checkpoint(path: Path) -> tuple[dict[str, Any], Arrays]:
    """Return header and arrays of a checkpoint.

    Raises:
        CheckpointError: missing, foreign, truncated, damaged or of another version.
    """
    try:
        with path.open("rb") as stream:
            _refuse_large(path, os.fstat(stream.fileno()).st_size)
            content = _content(stream)
    except FileNotFoundError:
        raise CheckpointError(f"{path}: no such file") from None
    except CheckpointError:
        raise
    except Exception as error:  # readers of zips and arrays check little
        raise CheckpointError(
            f"{path}: not a {FORMAT}, or damaged ({_one_line(error)})"
        ) from error
    try:
        header = json.loads(str(content.pop(_HEADER)), parse_constant=_not_json)
        found = (header["format"], header["version"])
    except (KeyError, TypeError, ValueError, RecursionError):
        raise CheckpointError(f"{path}: not a {FORMAT}") from None
    if found != (FORMAT, VERSION):
        raise CheckpointError(
            f"{path}: is {found[0]!s:.40} version {found[1]!s:.40}, "
            f"this program reads {FORMAT} version {VERSION}"
        )
    if header.get("arrays_sha256") != arrays_sha256(content):
        raise CheckpointError(f"{path}: damaged, its content does not match its hash")
    return header, content


@contextmanager
def taking_over(path: Path | str) -> Iterator[None]:
    """Turn what a header or arrays of something else raise in a block into one line.

    Raises:
        CheckpointError: the content of the file does not fit this program.
    """
    try:
        yield
    except CheckpointError:
        raise
    except (
        ArithmeticError, AttributeError, LookupError, TypeError, ValueError,
        msgspec.ValidationError,
    ) as error:  # fmt: skip
        kind = type(error).__name__
        raise CheckpointError(
            f"{path}: does not fit this program, {kind}: {_one_line(error)}"
        ) from error


def _content(stream: IO[bytes]) -> Arrays:
    """Return the arrays of a file of bounded size.

    Members stand in the file as they are, so that none is larger than the file.
    """
    _check_directory(stream)
    with zipfile.ZipFile(stream) as file:
        members = file.infolist()
        if any(member.compress_type != zipfile.ZIP_STORED for member in members):
            raise ValueError("it is compressed")
        if sum(member.file_size for member in members) > MOST_BYTES:
            raise ValueError("members that overlap")
        return {
            member.filename.removesuffix(".npy"): _array(file.read(member))
            for member in members
        }


def _check_directory(stream: IO[bytes]) -> None:
    """Refuse a zip with a directory larger than the one of any checkpoint."""
    size = stream.seek(0, os.SEEK_END)
    stream.seek(max(0, size - _ZIP_END.size - _ZIP64_BYTES))
    tail = stream.read(_ZIP_END.size + _ZIP64_BYTES)
    if len(tail) < _ZIP_END.size:
        raise ValueError("too short")
    mark, directory_bytes, _, remark_bytes = _ZIP_END.unpack(tail[-_ZIP_END.size :])
    if mark != b"PK\5\6" or remark_bytes or tail.startswith(_ZIP64_MARK):
        raise ValueError("its end is not that of a zip of ours")
    if directory_bytes > _MOST_DIRECTORY_BYTES:
        raise ValueError(f"a directory of {directory_bytes} bytes")


def _array(data: bytes) -> NDArray[Any]:
    """Return the array of an .npy file; its size must be that of its shape."""
    stream = BytesIO(data)
    if np.lib.format.read_magic(stream) != (1, 0):
        raise ValueError("an array of another format")
    shape, columns_first, dtype = np.lib.format.read_array_header_1_0(stream)
    if dtype.kind not in _KINDS:
        raise ValueError(f"an array of {dtype}")
    values = np.frombuffer(data, dtype, offset=stream.tell())
    return values.reshape(shape, order="F" if columns_first else "C").copy()


def _refuse_large(path: Path, size: int) -> None:
    if size > MOST_BYTES:
        raise CheckpointError(f"{path}: {size} bytes, {MOST_BYTES} at most")


def _not_json(word: str) -> NoReturn:
    raise ValueError(f"{word} is no number of JSON")


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__
