"""A file is replaced whole, or not at all."""

import errno
import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from biped_common.atomic_file import atomic_file


class PowerCutError(Exception):
    """Something goes wrong halfway through."""


@contextmanager
def no_file_larger_than(n_bytes: int) -> Iterator[None]:
    """Let writes beyond this size fail, as on a full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (n_bytes, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def file(tmp_path: Path) -> Path:
    file = tmp_path / "memory.npz"
    file.write_bytes(b"old")
    return file


def test_the_new_content_takes_the_place_of_the_old(file):
    with atomic_file(file) as stream:
        stream.write(b"new")
    assert file.read_bytes() == b"new"


def test_a_file_that_was_not_there_is_made(tmp_path):
    with atomic_file(tmp_path / "first.npz") as stream:
        stream.write(b"new")
    assert (tmp_path / "first.npz").read_bytes() == b"new"


def test_the_old_content_stands_until_the_block_has_ended(file):
    with atomic_file(file) as stream:
        stream.write(b"new")
        stream.flush()
        assert file.read_bytes() == b"old"


def test_no_temporary_file_remains(file):
    with atomic_file(file) as stream:
        stream.write(b"new")
    assert os.listdir(file.parent) == [file.name]


def test_the_new_file_is_readable_by_all(file):
    with atomic_file(file) as stream:
        stream.write(b"new")
    assert file.stat().st_mode & 0o777 == 0o644


@pytest.mark.parametrize(
    "error",
    [PowerCutError(), OSError(errno.ENOSPC, "No space left"), KeyboardInterrupt()],
    ids=lambda error: type(error).__name__,
)
def test_a_block_that_raises_changes_nothing(file, error):
    with pytest.raises(type(error)), atomic_file(file) as stream:
        stream.write(b"half of the n")
        raise error
    assert file.read_bytes() == b"old"
    assert os.listdir(file.parent) == [file.name]


def test_a_block_that_raises_makes_no_file(tmp_path):
    with (
        pytest.raises(PowerCutError),
        atomic_file(tmp_path / "first.npz") as stream,
    ):
        stream.write(b"half of the n")
        raise PowerCutError
    assert os.listdir(tmp_path) == []


def test_a_disk_that_takes_no_more_changes_nothing(file):
    with (
        pytest.raises(OSError, match=str(file)),
        no_file_larger_than(1000),
        atomic_file(file) as stream,
    ):
        stream.write(bytes(5000))
    assert file.read_bytes() == b"old"
    assert os.listdir(file.parent) == [file.name]


def test_a_folder_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError), atomic_file(tmp_path / "none" / "a.npz"):
        pass
    assert os.listdir(tmp_path) == []


def test_a_folder_in_the_place_of_the_file_is_left_alone(tmp_path):
    (tmp_path / "memory.npz").mkdir()
    with (
        pytest.raises(OSError),
        atomic_file(tmp_path / "memory.npz") as stream,
    ):
        stream.write(b"new")
    assert os.listdir(tmp_path) == ["memory.npz"]
