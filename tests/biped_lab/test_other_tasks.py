"""Learners compared on a program's task, by the command."""

import sys
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from biped_common.errors import BipedError
from biped_lab import library_learners
from biped_lab.other_tasks import arms, main, read_runs, read_task, table

PROGRAM = """
import gymnasium
from biped_lab.control_task import ControlTask
from learner_node.methods import MethodSettings

TASK = ControlTask(
    make=lambda: gymnasium.make("CartPole-v1"),
    radii=(1.2, 1.0, 0.08, 0.8),
    settings=MethodSettings(),
    goal=15.0,
    best=500.0,
    most_episodes=50,
)
"""


@pytest.fixture
def program(tmp_path):
    file = tmp_path / "short.py"
    file.write_text(PROGRAM)
    return file


def run(monkeypatch, program, *options):
    """Run the command; return its status."""
    words = [str(program), "--out", str(program.parent / "out"), *options]
    monkeypatch.setattr(sys, "argv", ["other_tasks", *words])
    try:
        return main()
    except SystemExit as end:
        return end.code


def test_runs_are_kept_and_not_repeated(program, monkeypatch, capsys):
    options = "--first", "5", "--arms", "random choice", "Q(λ)"
    assert run(monkeypatch, program, *options, "--seeds", "1") == 0
    file = program.parent / "out" / "short.csv"
    kept = file.read_text()
    assert run(monkeypatch, program, *options, "--seeds", "2") == 0
    assert file.read_text().startswith(kept)
    assert read_runs(file)["seed"].tolist() == [5, 5, 6, 6]
    first, _, *rows = capsys.readouterr().out.splitlines()[-4:]
    assert first.startswith("| learner | learned | episodes, median |")
    assert [row.split(" | ")[0] for row in rows] == ["| Q(λ)", "| random choice"]


def test_what_was_not_learned_is_censored(program):
    runs = pd.DataFrame(
        {
            "arm": ["XoL"] * 6 + ["XoL without fixed mode"] * 6,
            "seed": [*range(6)] * 2,
            "reached": [True] * 6 + [True, True] + [False] * 4,
            "episodes": [10, 20, 30, 30, 40, 50, 20, 40, 50, 50, 50, 50],
            "steps": [100] * 8 + [10] * 4,  # who fails early walks few steps
            "cpu_s": [0.0] * 12,
        }
    )
    rows = table(runs, read_task(program), np.random.default_rng(1)).rows
    assert [row[1] for row in rows] == ["6 of 6", "2 of 6"]
    assert rows[0][2].startswith("30 [") and rows[1][2].startswith("∞ [")
    assert rows[1][3].startswith("∞ [")


def test_without_continuous_actions_there_is_no_sac(program):
    assert "PPO" in arms(read_task(program)) and "SAC" not in arms(read_task(program))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "must define TASK, a ControlTask"),
        ("TASK = 1", "must define TASK, a ControlTask"),
        (None, "cannot be read (No such file or directory)"),
    ],
)
def test_a_program_without_a_task_is_refused(text, said, program, monkeypatch, capsys):
    program.unlink() if text is None else program.write_text(text)
    assert run(monkeypatch, program) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_an_arm_that_there_is_not_is_refused(program, monkeypatch, capsys):
    assert run(monkeypatch, program, "--arms", "DQN") == 2
    assert "--arms DQN: must be among XoL, " in capsys.readouterr().err


def test_without_its_extra_the_error_says_which(program, monkeypatch):
    monkeypatch.setitem(sys.modules, "stable_baselines3", None)
    with pytest.raises(BipedError, match=r"^PPO: .*pip install 'biped\[sb3\]'"):
        library_learners.learn(read_task(program), "PPO", 1)


def test_ppo_learns_until_it_is_good_enough(program, tmp_path, monkeypatch):
    pytest.importorskip("stable_baselines3")
    monkeypatch.setenv("SB3_LOGDIR", str(tmp_path / "log"))
    task = replace(read_task(program), most_episodes=500)
    learned = library_learners.learn(task, "PPO", 8201)
    assert learned.reached
    assert learned.episodes < 500
    assert learned.steps >= 2048  # the first update; nothing is tried before it
    assert not (tmp_path / "log").exists()
