"""A file that is no memory of this program is refused whole, and left alone."""

import gc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.training import TrainingRun
from learner_node.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from sim_node.pybullet_world import PyBulletWorld

Change = Callable[[dict[str, Any], dict[str, np.ndarray]], Any]

# A change of header and arrays that leaves a sound checkpoint, but of something else.
MISFITS: dict[str, tuple[Change, str]] = {
    "other alternatives": (
        lambda header, _: header["settings"]["learner"]["action"].update(
            alternatives=9
        ),
        r"array q is float64\(\d+, 2, 15\), this problem needs float64\(\d+, 2, 9\)",
    ),
    "a setting that there is not": (
        lambda header, _: header["settings"]["gait"].update(shoes=2),
        r"gait\.shoes = 2: unknown key",
    ),
    "a gait that cannot be walked": (
        lambda header, _: header["settings"]["gait"].update(step_length_m=0.45),
        r"cannot walk this gait",
    ),
    "no settings": (lambda header, _: header.pop("settings"), "settings"),
    "settings that are none": (
        lambda header, _: header.update(settings=[]),
        "does not fit this program",
    ),
    "no seed": (lambda header, _: header.pop("seed"), "seed"),
    "no progress": (lambda header, _: header.pop("progress"), "progress"),
    "no word on a trial": (lambda header, _: header.pop("trial_due"), "trial_due"),
    "computing time that is no number": (
        lambda header, _: header.update(cpu_s="long"),
        r"Expected `float`, got `str` - at `\$\.cpu_s`",
    ),
    "no tally": (lambda header, _: header.pop("tally"), "tally"),
    "a tally of something else": (
        lambda header, _: header["tally"].update(falls=3),
        "falls",
    ),
    "a subtask beyond the schedule": (
        lambda header, _: header["progress"].update(subtask=99),
        "subtask 99",
    ),
    "a subtask before the schedule": (
        lambda header, _: header["progress"].update(subtask=-1),
        r"Expected `int` >= 0 - at `\$\.progress\.subtask`",
    ),
    "random numbers of another kind": (
        lambda header, _: header["progress"]["rng"].update(bit_generator="MT19937"),
        "PCG64",
    ),
    "no random numbers of the robot": (
        lambda header, _: header.update(robot_rng=None),
        "state must be a dict",
    ),
    "no values": (lambda _, arrays: arrays.pop("memory/q"), "array q is missing"),
    "no states": (
        lambda _, arrays: arrays.pop("memory/state_life"),
        r"memory: array",
    ),
    "no log": (lambda _, arrays: arrays.pop("log/reward"), "columns"),
    "values of another type": (
        lambda _, arrays: arrays.update(
            {"memory/q": arrays["memory/q"].astype(np.float32)}
        ),
        "array q is float32",
    ),
    "fewer values than states": (
        lambda _, arrays: arrays.update({"memory/q": arrays["memory/q"][1:]}),
        "array q is",
    ),
    "a log of another length": (
        lambda _, arrays: arrays.update({"log/reward": np.zeros(9)}),
        "different length",
    ),
    "an array of nobody": (
        lambda _, arrays: arrays.update({"mood": np.zeros(3)}),
        "mood",
    ),
    "a log of single precision": (
        lambda _, arrays: arrays.update({"log/reward": np.zeros(1, dtype=np.float32)}),
        r"episode log: reward is float32\(1,\), must be a list of float64",
    ),
    "an end that there is not": (
        lambda _, arrays: arrays["log/end_cause"].fill(99),
        "episode log: end_cause is 99",
    ),
    "an end of another type": (
        lambda _, arrays: arrays.update({"log/end_cause": np.zeros(1)}),
        "end_cause is float64",
    ),
    "a walk of no length": (
        lambda _, arrays: arrays["log/target_ticks"].fill(0),
        "episode log: target_ticks is 0",
    ),
    "a value that is no number": (
        lambda _, arrays: arrays["memory/q"].fill(np.nan),
        "array q holds numbers that are not finite",
    ),
    "a state without a place": (
        lambda _, arrays: arrays["memory/state_centers"].fill(np.inf),
        "array state_centers holds numbers that are not finite",
    ),
    "a tally in words": (
        lambda header, _: header["tally"].update(simulated_ticks="many"),
        r"Expected `int`, got `str` - at `\$\.tally\.simulated_ticks`",
    ),
    "a tally below nothing": (
        lambda header, _: header["tally"].update(evaluations=-1),
        r"\$\.tally\.evaluations",
    ),
    "a tally that is a list": (
        lambda header, _: header.update(tally=[3]),
        r"\$\.tally",
    ),
    "half a tally": (
        lambda header, _: header["tally"].pop("evaluations"),
        "tally: counts",
    ),
    "a trial that is neither due nor not": (
        lambda header, _: header.update(trial_due="soon"),
        r"\$\.trial_due",
    ),
    "versions in a list": (
        lambda header, _: header.update(versions=["1.0"]),
        r"\$\.versions",
    ),
    "a version that colours the screen": (
        lambda header, _: header["versions"].update(numpy="[red]\x1b[31m"),
        r"\$\.versions\[\.\.\.\]",
    ),
    "ticks that were never walked": (
        lambda header, _: header.update(walked_ticks={"computed": "all"}),
        r"\$\.walked_ticks\.computed",
    ),
    "a seed in words": (lambda header, _: header.update(seed="seven"), "memory.npz: "),
    "a generator's state in words": (
        lambda header, _: header["progress"]["rng"]["state"].update(state="x"),
        "memory.npz: does not fit",
    ),
    "a generator's state beyond all": (
        lambda header, _: header["progress"]["rng"]["state"].update(state=10**60),
        "memory.npz: does not fit",
    ),
    "another version": (lambda header, _: header.update(version=1), "version 1"),
    "another format": (lambda header, _: header.update(format="cart"), "is cart"),
}


@pytest.fixture(scope="module")
def memory(tmp_path_factory) -> bytes:
    """One episode's memory."""
    file = tmp_path_factory.mktemp("memory") / "memory.npz"
    run = TrainingRun(quick(*SHORT), seed=0)
    run.episode()
    run.save(file)
    run.close()
    return file.read_bytes()


@pytest.fixture
def misfit(tmp_path: Path, memory: bytes) -> Callable[[Change], Path]:
    """Write a memory with a change in it, its hash made to fit."""

    def write(change: Change) -> Path:
        file = tmp_path / "memory.npz"
        file.write_bytes(memory)
        header, arrays = read_checkpoint(file)
        header.pop("arrays_sha256")
        change(header, arrays)
        write_checkpoint(file, header, arrays)
        return file

    return write


def foreign_files(memory: bytes) -> dict[str, bytes]:
    third = len(memory) // 3
    damaged = bytearray(memory)
    damaged[third] ^= 0x10
    return {
        "nothing": b"",
        "text": b"episodes: 3\n",
        "its first third": memory[:third],
        "all but its last byte": memory[:-1],
        "a flipped bit": bytes(damaged),
        "zeros": bytes(1000),
    }


def test_an_unchanged_memory_is_taken(misfit):
    run = TrainingRun.load(misfit(lambda header, arrays: None))
    run.close()
    assert run.episodes == 1


@pytest.mark.parametrize("what", MISFITS)
def test_a_memory_does_not_fit_with(misfit, what):
    change, reason = MISFITS[what]
    file = misfit(change)
    with pytest.raises(CheckpointError, match=reason) as caught:
        TrainingRun.load(file)
    assert str(caught.value).startswith(f"{file}: ")
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("verb", ["learn --resume", "walk --memory"])
@pytest.mark.parametrize("what", foreign_files(bytes(9)))
def test_a_file_is_refused_that_holds(biped, tmp_path, memory, what, verb):
    content = foreign_files(memory)[what]
    (tmp_path / "memory.npz").write_bytes(content)
    outcome = biped(*verb.split(), "memory.npz")
    assert (outcome.status, outcome.out) == (2, "")
    assert len(outcome.err.splitlines()) == 1
    assert "memory.npz: not a biped checkpoint" in outcome.err


@pytest.mark.parametrize("what", foreign_files(bytes(9)))
def test_a_refused_file_is_left_alone(biped, tmp_path, memory, what):
    content = foreign_files(memory)[what]
    (tmp_path / "memory.npz").write_bytes(content)
    biped("learn", "--resume", "memory.npz", "--episodes", 2)
    assert (tmp_path / "memory.npz").read_bytes() == content
    assert [file.name for file in tmp_path.iterdir()] == ["memory.npz"]


def test_a_misfit_is_left_alone(biped, tmp_path, misfit):
    content = misfit(MISFITS["other alternatives"][0]).read_bytes()
    assert biped("learn", "--resume", "memory.npz").status == 2
    assert (tmp_path / "memory.npz").read_bytes() == content


def test_flipped_bits_all_over_the_file_are_noticed(tmp_path, memory):
    file = tmp_path / "memory.npz"
    file.write_bytes(memory)
    header, arrays = read_checkpoint(file)
    taken = []
    for position in range(0, len(memory), len(memory) // 97):
        damaged = bytearray(memory)
        damaged[position] ^= 0x01
        file.write_bytes(damaged)
        try:
            found_header, found = read_checkpoint(file)
        except CheckpointError:
            continue
        same = found_header == header and all(
            np.array_equal(found[name], arrays[name], equal_nan=True) for name in arrays
        )
        taken += [] if same else [position]
    assert taken == []


def open_worlds() -> int:
    """Count Bullet's open worlds."""
    return sum(
        isinstance(each, PyBulletWorld) and each.client != 0
        for each in gc.get_objects()
    )


def test_a_refused_memory_leaves_no_world_behind(misfit):
    file = misfit(MISFITS["other alternatives"][0])
    before = open_worlds()
    with pytest.raises(CheckpointError):
        TrainingRun.load(file)
    assert open_worlds() == before
