"""Walks of one memory on two engines, put side by side."""

import sys

import numpy as np
import pytest
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.training import TrainingRun
from biped_lab.engine_agreement import GreedyWalk, agreement, main, walk
from sim_node.engines import ENGINES


def greedy(zmp_m: np.ndarray, joint_references: np.ndarray) -> GreedyWalk:
    return GreedyWalk("any", True, "completed", 0.0, 0.0, zmp_m, joint_references)


@pytest.fixture(scope="module")
def memory(tmp_path_factory):
    """Learn a walk of one step; return its folder."""
    folder = tmp_path_factory.mktemp("seed_0")
    run = TrainingRun(quick(*SHORT), seed=0)
    run.run(60, False, lambda _: True)
    run.save(folder / "memory.npz")
    run.close()
    return folder


@pytest.mark.parametrize("engine", list(ENGINES))
def test_a_memory_walks_on_the_engine_asked_for(memory, engine):
    run = TrainingRun.load(memory / "memory.npz")
    run.close()
    walked = walk(run, engine)
    assert (walked.engine, walked.completed, walked.walked_s) == (engine, True, 3.75)
    assert walked.zmp_m.shape == (1875, 2)


def test_walks_are_compared_as_far_as_they_are_alike_and_as_far_as_both_go():
    q = np.arange(10.0)[:, None] * np.ones(12)
    zmp_m = np.zeros((10, 2))
    apart_m = zmp_m.copy()
    apart_m[:, 0], apart_m[4:, 0] = 0.003, 0.004
    other_q = q[:8].copy()
    other_q[4:, 3] += 1.0
    found = agreement(greedy(zmp_m, q), greedy(apart_m[:8], other_q))
    assert found.alike_s == pytest.approx(0.008)
    assert found.zmp_rms_alike_m == pytest.approx(0.003)
    assert found.zmp_rms_m == pytest.approx(np.sqrt((0.003**2 + 0.004**2) / 2))


def test_walks_that_begin_with_other_motions_are_never_alike():
    q, zmp_m = np.zeros((5, 12)), np.zeros((5, 2))
    found = agreement(greedy(zmp_m, q), greedy(zmp_m + 0.001, q + 0.1))
    assert (found.alike_s, found.zmp_rms_alike_m) == (0.0, 0.0)


def test_the_table_has_a_row_per_memory(memory, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["engine_agreement", str(memory)])
    assert main() == 0
    head, rule, row, _, *summary = capsys.readouterr().out.splitlines()
    assert head.count("|") == rule.count("|") == row.count("|")
    assert row.startswith(f"| {memory.name} | 3.75 | completed |")
    assert [line.split(":")[0] for line in summary] == ["pybullet", "kinematic"]


def test_a_folder_without_a_memory_is_named(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["engine_agreement", str(tmp_path)])
    assert main() == 2
    assert "memory.npz" in capsys.readouterr().err
