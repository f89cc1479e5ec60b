"""What a page shows, wherever it comes from: a moment, a walk's course, its traces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Moment:
    """The robot and its surroundings at one control tick; world frame."""

    torso_position_m: Array
    """(3,)"""
    torso_quaternion: Array
    """(4,) (w, x, y, z)."""
    joint_position_rad: Array
    """(12,)"""
    zmp_m: Array
    """(2,) measured."""
    zmp_reference_m: Array
    """(2,)"""
    support_m: Array
    """(n, 2) points whose convex hull is the support polygon."""
    waist_m: Array
    """(n, 3) the waist's way so far."""
    waist_ahead_m: Array
    """(n, 3) its way ahead, as far as it is corrected already."""


@dataclass(frozen=True)
class Course:
    """A walk as planned, n control ticks; world frame [m]."""

    static_waist_m: Array
    """(n, 3) the waist without corrections."""
    left_foot_m: Array
    """(n, 3)"""
    right_foot_m: Array
    """(n, 3)"""


@dataclass(frozen=True)
class Traces:
    """What was measured along a walk, n rows."""

    time_s: Array
    """(n,) of the walk."""
    zmp_error_m: Array
    """(n,) largest norm since the row before."""
    correction_m: Array
    """(n, 2) chosen by the learner; NaN where none is known."""

    def until(self, time_s: float) -> Traces:
        """Return the rows up to a time of the walk."""
        n = int(np.searchsorted(self.time_s, time_s, side="right"))
        return Traces(self.time_s[:n], self.zmp_error_m[:n], self.correction_m[:n])


NO_TRACES = Traces(np.zeros(0), np.zeros(0), np.zeros((0, 2)))


@dataclass(frozen=True)
class Episodes:
    """T_err of learning episodes, in their order."""

    number: Array
    """(n,) from 1."""
    t_err: Array
    """(n,) NaN where a walk could not be judged."""
    completed: NDArray[np.bool_]
    """(n,) whether the target time was reached."""


@dataclass(frozen=True)
class LearnerFigures:
    """How far a learner has come."""

    state: str
    """What it does, in a word or two."""
    target_time_s: float
    walk_time_s: float | None
    """Time of the whole walk, where known."""
    subtask: int
    """0-based."""
    subtasks: int
    successes: int
    """In the present subtask."""
    episodes: int
    survival: float
    """Walked over target time, mean of the last episodes."""
    memory: Mapping[str, float]
    """Figures of the memory, under names of the learner's own."""
    t_err_estimate: float | None
    simulated_s: float
    """Walked in learning episodes."""
    computed_s: float | None = None
    """Steps of the physics, where known."""
    replayed_s: float | None = None
    """Known from earlier walks instead, where known."""
    given_up: int = 0
    """Walks that ended from outside."""
