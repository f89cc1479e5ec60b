"""Contestants behind the Learner seam: one training run each, with exact replay."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_bringup.replay import DEFAULT_MEMORY_BYTES
from biped_bringup.run_settings import RunSettings
from biped_bringup.training import TrainingRun
from biped_bringup.walker import WalkedTicks
from biped_lab.contestant import (
    AnyOptions,
    Contestant,
    Entry,
    NoOptions,
    log_table,
)
from learner_node.learner import Learner
from learner_node.methods import MakeLearner, MethodSettings, make_learner
from learner_node.problem import Problem


class LearnerContestant:
    """A training run that takes note of its learner's figures after each episode."""

    def __init__(self, run: TrainingRun) -> None:
        """Take over a run that has just begun, or was just loaded."""
        self._run = run
        self._figures: dict[str, list[float]] = run.notes.setdefault("figures", {})

    @property
    def ticks(self) -> WalkedTicks:
        """Where the control ticks of all walks came from."""
        return self._run.walker.ticks

    @property
    def cpu_s(self) -> float:
        """Processor time of all episodes."""
        return self._run.cpu_s

    @property
    def episodes(self) -> int:
        """Learning episodes so far."""
        return self._run.episodes

    def episode(self) -> None:
        """Walk one more learning episode, and the frozen trial where one is due."""
        self._run.episode()
        for name, value in self._run.session.learner.figures().items():
            self._figures.setdefault(name, []).append(value)

    def milestone(self, name: str) -> int | None:
        """Return the number of episodes when a milestone was reached."""
        found: int | None = getattr(self._run.tally, f"{name}_episodes")
        return found

    def table(self) -> dict[str, NDArray[Any]]:
        """Return one row per episode, by column."""
        columns = log_table(self._run.log)
        for name, values in self._figures.items():
            columns[name] = np.array(values, dtype=np.float64)
        return columns

    def figures(self) -> dict[str, Any]:
        """Return hashes and times, the same in every run."""
        tally = self._run.tally
        return {
            "simulated_ticks": tally.simulated_ticks,
            "evaluation_ticks": tally.evaluation_ticks,
            "evaluations": tally.evaluations,
            "memory_sha256": self._run.session.memory_sha256(),
            "trajectory_sha256": tally.trajectories_sha256,
        }

    def save(self, path: Path) -> None:
        """Write atomically all that is needed to go on bit for bit."""
        self._run.save(path)

    def close(self) -> None:
        """End the world."""
        self._run.close()


def learner_entry(
    module: str,
    options: type[AnyOptions],
    make: Callable[[AnyOptions, MethodSettings, Problem, np.random.Generator], Learner],
) -> Entry[AnyOptions]:
    """Return the entry of a learner of one's own.

    Args:
        module: `__name__` of where it is.
        options: its constants.
        make: returns a learner that knows nothing yet.
    """

    def begin(settings: RunSettings, own: AnyOptions, seed: int) -> Contestant:
        return _begin(settings, seed, partial(make, own))

    def resume(
        path: Path, settings: RunSettings, own: AnyOptions, seed: int
    ) -> Contestant:
        return _resume(path, partial(make, own))

    return Entry(options, begin, resume, module)


def _begin(settings: RunSettings, seed: int, make: MakeLearner) -> Contestant:
    return LearnerContestant(
        TrainingRun(settings, seed, DEFAULT_MEMORY_BYTES, make=make)
    )


def _resume(path: Path, make: MakeLearner) -> Contestant:
    return LearnerContestant(TrainingRun.load(path, DEFAULT_MEMORY_BYTES, make=make))


BY_SETTING = Entry(
    NoOptions,
    lambda settings, _, seed: _begin(settings, seed, make_learner),
    lambda path, settings, _, seed: _resume(path, make_learner),
    "biped_bringup.training",
)
"""Whom `learner.method` names: XoL, Q(lambda)."""
