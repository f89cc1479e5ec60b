"""Checkpoints come back as they were written, or are refused with a reason."""

import io
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as some

from learner_node.checkpoint import (
    FORMAT,
    VERSION,
    CheckpointError,
    read_checkpoint,
    write_checkpoint,
)

HEADER = {"seed": 3, "progress": {"estimate": 0.1 + 0.2, "rng": 2**100}, "note": "Δx"}
ARRAYS = {
    "memory/q": np.linspace(0.0, 1.0, 6).reshape(2, 3),
    "memory/fixed": np.array([True, False]),
    "memory/episode": np.array(7),
    "log/t_err": np.array([0.5, np.nan]),
}
ARRAYS_ADDED = {"format", "version", "arrays_sha256"}
# Zip: where the directory entry of a file has its version, flags and compression.
ENTRY = b"PK\x01\x02"
VERSION_NEEDED, FLAGS, COMPRESSION = 6, 8, 10

Content = tuple[dict[str, Any], dict[str, np.ndarray]]


def same(one: Content, other: Content) -> bool:
    """Whether headers and arrays agree to the last bit."""
    return one[0] == other[0] and {
        name: (array.dtype, array.shape, array.tobytes())
        for name, array in one[1].items()
    } == {
        name: (array.dtype, array.shape, array.tobytes())
        for name, array in other[1].items()
    }


@pytest.fixture
def file(tmp_path: Path) -> Path:
    """A small checkpoint."""
    file = tmp_path / "memory.npz"
    write_checkpoint(file, HEADER, ARRAYS)
    return file


@pytest.fixture
def refusal(tmp_path: Path) -> Callable[[bytes], str]:
    """Return why this content is refused."""

    def reason(content: bytes) -> str:
        file = tmp_path / "refused.npz"
        file.write_bytes(content)
        with pytest.raises(CheckpointError) as caught:
            read_checkpoint(file)
        message = str(caught.value)
        assert message.startswith(f"{file}: ")
        assert len(message.splitlines()) == 1
        return message.removeprefix(f"{file}: ")

    return reason


def saved(
    tmp_path: Path, save: Callable[..., None], *args: Any, **kwargs: Any
) -> bytes:
    """What a function of NumPy writes."""
    with (tmp_path / "foreign").open("wb") as stream:
        save(stream, *args, **kwargs)
    return (tmp_path / "foreign").read_bytes()


# -- round trip --------------------------------------------------------------------


def test_a_header_comes_back_with_its_marks_of_origin(file):
    header, _ = read_checkpoint(file)
    assert header.keys() - HEADER.keys() == ARRAYS_ADDED
    assert {key: header[key] for key in HEADER} == HEADER


def test_arrays_come_back_bit_for_bit(file):
    header, arrays = read_checkpoint(file)
    assert same((header, arrays), (header, ARRAYS))


numbers = st.sampled_from([np.float64, np.float32, np.int64, np.uint8, np.bool_])
shapes = some.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=4)
names = st.text(st.characters(codec="ascii", categories=["L", "N"]), min_size=1)


@settings(
    deadline=None,
    max_examples=50,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(
    arrays=st.dictionaries(
        names.map("memory/{}".format), numbers.flatmap(lambda n: some.arrays(n, shapes))
    ),
    note=st.text(),
)
def test_any_arrays_and_any_text_come_back(tmp_path, arrays, note):
    write_checkpoint(tmp_path / "any.npz", {"note": note}, arrays)
    header, found = read_checkpoint(tmp_path / "any.npz")
    assert header["note"] == note
    assert same((header, found), (header, arrays))


def test_a_checkpoint_without_arrays_comes_back(tmp_path):
    write_checkpoint(tmp_path / "empty.npz", {"seed": 3}, {})
    header, arrays = read_checkpoint(tmp_path / "empty.npz")
    assert (header["seed"], arrays) == (3, {})


def test_the_same_content_is_the_same_file(file, tmp_path):
    write_checkpoint(tmp_path / "again.npz", HEADER, ARRAYS)
    assert (tmp_path / "again.npz").read_bytes() == file.read_bytes()


# -- no pickle ---------------------------------------------------------------------


def test_a_checkpoint_is_read_without_pickle(file):
    with np.load(file, allow_pickle=False) as content:
        kinds = {content[name].dtype.kind for name in content.files}
    assert kinds <= set("fbiU")


def test_an_object_is_not_written(tmp_path):
    with pytest.raises(ValueError, match="pickle"):
        write_checkpoint(tmp_path / "a.npz", {}, {"memory/q": np.array([{}])})
    assert os.listdir(tmp_path) == []


def test_a_pickle_is_refused_unopened(refusal, tmp_path):
    class Bomb:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "opened"),)

    bomb = np.array([Bomb()], dtype=object)
    assert refusal(saved(tmp_path, np.savez, header=bomb)).startswith("not a biped")
    assert not (tmp_path / "opened").exists()


# -- files of something else -------------------------------------------------------


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(CheckpointError, match=r"none\.npz: no such file$"):
        read_checkpoint(tmp_path / "none.npz")


def test_a_folder_is_no_checkpoint(tmp_path):
    with pytest.raises(CheckpointError, match=r"not a biped checkpoint.*directory"):
        read_checkpoint(tmp_path)


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"x",
        b"episodes: 3\n",
        bytes(1000),
        b"PK\x03\x04",
        b"\x93NUMPY",
        b"\x80\x04.",
    ],
    ids=[
        "nothing",
        "a byte",
        "text",
        "zeros",
        "a zip's start",
        "a npy's",
        "a pickle's",
    ],
)
def test_a_foreign_file_is_no_checkpoint(refusal, content):
    assert refusal(content).startswith(f"not a {FORMAT}")


def test_a_single_array_is_no_checkpoint(refusal, tmp_path):
    content = saved(tmp_path, np.save, np.zeros(3))
    assert refusal(content).startswith(f"not a {FORMAT}")


@pytest.mark.parametrize(
    "arrays",
    [
        {},
        {"q": np.zeros(3)},
        {"header": np.zeros(3)},
        {"header": np.array("gait")},
        {"header": np.array("[1, 2]")},
        {"header": np.array("{}")},
        {"header": np.array(f'{{"format": "{FORMAT}"}}')},
        {"header": np.array("[" * 100_000)},
        {"header": np.array(f'{{"format": "{FORMAT}", "version": 2, "seed": NaN}}')},
    ],
    ids=[
        "empty",
        "nameless",
        "numbers",
        "text",
        "a list",
        "no format",
        "no version",
        "deep brackets",
        "no number",
    ],
)
def test_other_arrays_are_no_checkpoint(refusal, tmp_path, arrays):
    assert refusal(saved(tmp_path, np.savez, **arrays)) == f"not a {FORMAT}"


def test_another_version_is_named_beside_our_own(refusal, tmp_path):
    text = f'{{"format": "{FORMAT}", "version": {VERSION + 1}}}'
    reason = refusal(saved(tmp_path, np.savez, header=np.array(text)))
    assert reason == (
        f"is {FORMAT} version {VERSION + 1}, "
        f"this program reads {FORMAT} version {VERSION}"
    )


def test_another_format_is_named(refusal, tmp_path):
    text = f'{{"format": "cart", "version": {VERSION}}}'
    reason = refusal(saved(tmp_path, np.savez, header=np.array(text)))
    assert reason.startswith(f"is cart version {VERSION}")


@pytest.mark.parametrize(
    "change",
    [
        lambda arrays: arrays.pop("memory/q"),
        lambda arrays: arrays.update({"memory/more": np.zeros(3)}),
        lambda arrays: arrays["memory/q"].__setitem__((0, 0), 1.0),
        lambda arrays: arrays.update({"memory/q": arrays["memory/q"].reshape(3, 2)}),
        lambda arrays: arrays.update({"memory/q": arrays["memory/q"].astype("f4")}),
    ],
    ids=["one less", "one more", "another value", "another shape", "another type"],
)
def test_arrays_that_are_not_those_of_the_header_are_refused(
    refusal, file, tmp_path, change
):
    with np.load(file) as content:
        arrays = {name: content[name] for name in content.files}
    change(arrays)
    reason = refusal(saved(tmp_path, np.savez, **arrays))
    assert reason == "damaged, its content does not match its hash"


# -- damage ------------------------------------------------------------------------


def test_a_truncated_checkpoint_is_refused_wherever_it_ends(refusal, file):
    content = file.read_bytes()
    reasons = {refusal(content[:length])[:22] for length in range(len(content))}
    assert reasons == {f"not a {FORMAT}"}


def test_a_flipped_byte_is_refused_or_does_no_harm(tmp_path):
    file, harmed = tmp_path / "memory.npz", []
    write_checkpoint(file, {"seed": 3}, {"q": np.arange(3.0)})
    content, whole = file.read_bytes(), read_checkpoint(file)
    any_mask = np.random.default_rng(0).integers(1, 256, len(content))
    for position in range(len(content)):
        for mask in (0x01, 0x20, any_mask[position]):
            damaged = bytearray(content)
            damaged[position] ^= mask
            file.write_bytes(damaged)
            try:
                unharmed = same(read_checkpoint(file), whole)
            except CheckpointError:
                continue
            except Exception:
                unharmed = False
            if not unharmed:
                harmed.append((position, hex(mask)))
    assert harmed == []


@pytest.mark.parametrize(
    ("offset", "value"),
    [
        (FLAGS, 0x01),
        (FLAGS, 0x20),
        (FLAGS, 0x40),
        (COMPRESSION, 99),
        (VERSION_NEEDED, 99),
    ],
    ids=["encrypted", "patched", "strongly encrypted", "squeezed", "of the future"],
)
def test_a_zip_that_cannot_be_unpacked_is_refused(refusal, file, offset, value):
    content = bytearray(file.read_bytes())
    for entry in re.finditer(re.escape(ENTRY), bytes(content)):
        content[entry.start() + offset] = value
    assert refusal(bytes(content)).startswith(f"not a {FORMAT}, or damaged (")


# -- bounds ------------------------------------------------------------------------

# 4 GB in each of these; reading them must take less than this.
BOUND_BYTES = 2**28
READ_WITHIN_BOUNDS = f"""
import pathlib, resource, sys
from learner_node.checkpoint import CheckpointError, read_checkpoint
resource.setrlimit(resource.RLIMIT_DATA, ({BOUND_BYTES}, {BOUND_BYTES}))
try:
    read_checkpoint(pathlib.Path(sys.argv[1]))
except CheckpointError as error:
    print(error)
"""


def npy_of_shape(shape: tuple[int, ...]) -> bytes:
    """The file of an array that lacks its numbers."""
    stream = io.BytesIO()
    described = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(stream, described)
    return stream.getvalue()


def write_zip(file: Path, members: dict[str, bytes], **options: Any) -> None:
    with zipfile.ZipFile(file, "w", **options) as content:
        for name, data in members.items():
            content.writestr(name, data)


def write_deflated(file: Path) -> None:
    with (
        zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as content,
        content.open("header.npy", "w", force_zip64=True) as member,
    ):
        member.write(npy_of_shape((2**26,)))
        for _ in range(64):
            member.write(bytes(2**20))


def write_with_large_directory(file: Path) -> None:
    write_zip(file, {f"{i}.npy": b"" for i in range(5_000)})


def write_hole(file: Path) -> None:
    with file.open("wb") as stream:
        stream.truncate(2**32)


BOMBS: dict[str, tuple[Callable[[Path], None], str]] = {
    "much in little": (write_deflated, "it is compressed"),
    "a shape of 256 TiB": (
        lambda file: write_zip(file, {"header.npy": npy_of_shape((2**45,))}),
        "reshape",
    ),
    "a shape of more than there are numbers": (
        lambda file: write_zip(file, {"header.npy": npy_of_shape((2**62, 2**62))}),
        r"\(",
    ),
    "many members": (write_with_large_directory, r"directory of \d+ bytes|zip of ours"),
    "a file of 4 GB": (write_hole, "4294967296 bytes, 67108864 at most"),
}


@pytest.mark.parametrize("what", BOMBS)
def test_a_file_is_refused_without_taking_memory_that_holds(tmp_path, what):
    write, reason = BOMBS[what]
    file = tmp_path / "memory.npz"
    write(file)
    done = subprocess.run(
        [sys.executable, "-c", READ_WITHIN_BOUNDS, str(file)],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith(f"{file}: ")
    assert done.stdout.count("\n") == 1
    assert re.search(reason, done.stdout)


def test_an_endless_device_is_no_checkpoint():
    with pytest.raises(CheckpointError, match="not a biped checkpoint"):
        read_checkpoint(Path("/dev/zero"))


def test_what_could_not_be_read_again_is_not_written(file):
    before = file.read_bytes()
    with pytest.raises(CheckpointError, match="67108864 at most"):
        write_checkpoint(file, HEADER, {"memory/q": np.zeros(2**23)})
    assert file.read_bytes() == before


# -- writing -----------------------------------------------------------------------


def test_a_checkpoint_takes_the_place_of_an_older_one(file):
    write_checkpoint(file, HEADER | {"seed": 4}, ARRAYS)
    assert read_checkpoint(file)[0]["seed"] == 4


@pytest.mark.parametrize(
    ("header", "arrays"),
    [
        ({"seed": object()}, ARRAYS),
        (HEADER, {"memory/q": np.array([None])}),
    ],
    ids=["header", "array"],
)
def test_what_cannot_be_written_leaves_the_older_one(file, header, arrays):
    older = file.read_bytes()
    with pytest.raises((TypeError, ValueError)):
        write_checkpoint(file, header, arrays)
    assert file.read_bytes() == older
    assert os.listdir(file.parent) == [file.name]
