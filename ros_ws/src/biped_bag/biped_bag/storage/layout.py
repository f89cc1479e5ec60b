"""Which files make up a bag: a rosbag2 folder, or a single MCAP file."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

from biped_bag.errors import BagError
from biped_bag.storage.metadata import FILE_NAME, BagMetadata, read_metadata


def broken(bag: Path, why: str) -> BagError:
    """Return the error that sends the user of a broken bag to `biped bag recover`."""
    return BagError(f"{why}; `biped bag recover {bag} OUT` saves what is left")


def find_files(path: Path) -> tuple[tuple[Path, ...], BagMetadata | None]:
    """Return a finished bag's MCAP files, in the order of recording, and its metadata.

    A single MCAP file has no metadata.

    Raises:
        BagError: there is no such path, no bag, or metadata.yaml does not say which.
    """
    if path.is_file():
        return (path,), None
    if not path.is_dir():
        raise BagError(f"{path}: no such file or folder")
    present = data_files(path)
    if not (path / FILE_NAME).is_file():
        raise broken(path, f"{path}: has no {FILE_NAME}, its recording did not end")
    try:
        metadata = read_metadata(path)
    except BagError as error:
        raise broken(path, str(error)) from None
    data = tuple(path / file.path for file in metadata.files)
    if set(data) != set(present):
        raise broken(path, f"{path}: {FILE_NAME} does not list the files here")
    return data, metadata


def data_files(folder: Path) -> tuple[Path, ...]:
    """Return the MCAP files of a folder, in the order of recording.

    Raises:
        BagError: there is none.
    """
    files = sorted(
        (file for file in folder.glob("*.mcap") if file.is_file()), key=_number_in_name
    )
    if not files:
        raise BagError(f"{folder}: not a bag, it has no .mcap file")
    return tuple(files)


def holds_bag(folder: Path) -> bool:
    """Return whether a folder is a bag, or has been begun as one."""
    return (folder / FILE_NAME).exists() or any(folder.glob("*.mcap"))


def fresh_folder(folder: Path) -> Path:
    """Return the folder, or with _2, _3, ... behind it the first that is no bag."""
    name = folder.resolve().name  # that of "." has one, too
    numbered = (folder.parent / f"{name}_{n}" for n in itertools.count(2))
    candidates = itertools.chain((folder,), numbered)
    return next(path for path in candidates if not holds_bag(path))


def refuse_existing(out: Path) -> None:
    """Return if a bag that is made out of another one can be put there.

    Raises:
        BagError: something is there already.
    """
    if out.exists() or out.is_symlink():
        raise BagError(f"{out}: is there already, and is never overwritten")


def _number_in_name(file: Path) -> tuple[int, str]:
    """Sort bag_10.mcap behind bag_9.mcap."""
    number = re.search(r"_(\d+)$", file.stem)
    return (int(number[1]) if number else 0, file.name)
