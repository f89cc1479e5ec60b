"""One file that holds a run: arrays and a JSON header in a NumPy zip, no pickle.

What failures do:
    writing fails (disk full, folder gone): the previous file stays as it was.
    reading finds something else (foreign, truncated, damaged, another version):
    CheckpointError, one line that says what and where; nothing is taken over.
"""

from __future__ import annotations

import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from biped_common.atomic_file import atomic_file
from biped_common.errors import BipedError
from learner_node.memory import Arrays, arrays_sha256

FORMAT = "biped checkpoint"
VERSION = 2
_HEADER = "header"
# All that reading a damaged zip has been seen to raise.
_DAMAGE = (
    EOFError,
    KeyError,
    RuntimeError,
    ValueError,
    zipfile.BadZipFile,
    zlib.error,
)


class CheckpointError(BipedError, ValueError):
    """The file is no usable checkpoint; the message says why."""


def write_checkpoint(path: Path, header: dict[str, Any], arrays: Arrays) -> None:
    """Write a checkpoint atomically.

    Args:
        path: the file, conventionally `*.npz`.
        header: anything JSON can hold.
        arrays: numeric arrays by name.
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


def read_checkpoint(path: Path) -> tuple[dict[str, Any], Arrays]:
    """Return header and arrays of a checkpoint.

    Raises:
        CheckpointError: missing, foreign, truncated, damaged or of another version.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            content = {name: file[name] for name in file.files}
    except FileNotFoundError:
        raise CheckpointError(f"{path}: no such file") from None
    except (AttributeError, TypeError):
        # numpy returns a bare array for a .npy file, which has no names.
        raise CheckpointError(f"{path}: not a {FORMAT}") from None
    except (*_DAMAGE, OSError) as error:
        raise CheckpointError(
            f"{path}: not a {FORMAT}, or damaged ({_one_line(error)})"
        ) from error
    try:
        header = json.loads(str(content.pop(_HEADER)))
        found = (header["format"], header["version"])
    except (KeyError, TypeError, ValueError):
        raise CheckpointError(f"{path}: not a {FORMAT}") from None
    if found != (FORMAT, VERSION):
        raise CheckpointError(
            f"{path}: is {found[0]} version {found[1]}, "
            f"this program reads {FORMAT} version {VERSION}"
        )
    if header.get("arrays_sha256") != arrays_sha256(content):
        raise CheckpointError(f"{path}: damaged, its content does not match its hash")
    return header, content


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__
