"""An open-loop plan: corrections of the waist (Section 4.2), each held for a while.

What is held for a knot spacing h of the B-spline (`trajectory_node.bspline`) is one of
its control points. Plans keep to the learner's alternatives.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_common.timing import (
    CONTROL_PERIOD_US,
    LEARNING_PERIOD_US,
    TICKS_PER_LEARNING_TICK,
    microseconds,
)

COMPONENTS = 2


@dataclass(frozen=True)
class PlanSpace:
    """The plans of a walk: (points, 2) corrections, each one of the alternatives."""

    points: int
    """Corrections of the whole walk."""
    spacing_us: int
    """How long each of them is held [us]."""
    limit_m: float
    """Largest correction [m]."""
    alternatives: int
    """Na: equally spaced corrections from -limit to limit."""

    @classmethod
    def of_knots(cls, settings: RunSettings) -> PlanSpace:
        """Return the plans of a correction per knot spacing."""
        return cls._of(settings, microseconds(settings.correction.knot_spacing_s))

    @classmethod
    def of_learning_ticks(cls, settings: RunSettings) -> PlanSpace:
        """Return the plans of a correction per learning tick, as learners decide."""
        return cls._of(settings, LEARNING_PERIOD_US)

    @classmethod
    def _of(cls, settings: RunSettings, spacing_us: int) -> PlanSpace:
        points = _points(settings.gait.walk_ticks, spacing_us)
        action = settings.learner.action
        return cls(points, spacing_us, action.limit_m, action.alternatives)

    def point_at(self, control_tick: int) -> int:
        """Return which point a decision at a control tick takes."""
        return control_tick * CONTROL_PERIOD_US // self.spacing_us

    def points_until(self, control_ticks: int) -> int:
        """Return how many points, from the first, have a part in a walk so long."""
        return _points(control_ticks, self.spacing_us)

    def nearest(self, plan_m: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the alternatives that are nearest to corrections [m], any shape."""
        most = self.alternatives - 1
        place = (plan_m / self.limit_m + 1.0) * (0.5 * most)
        return np.clip(np.rint(place), 0, most).astype(np.int64)

    def corrections_m(self, chosen: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the corrections [m] that alternatives stand for, any shape."""
        return np.linspace(-self.limit_m, self.limit_m, self.alternatives)[chosen]

    def random(self, rng: np.random.Generator, points: int) -> NDArray[np.float64]:
        """Return (points, 2) corrections [m], all alternatives equally likely."""
        return self.corrections_m(
            rng.integers(self.alternatives, size=(points, COMPONENTS))
        )


def _points(control_ticks: int, spacing_us: int) -> int:
    last = (control_ticks - 1) // TICKS_PER_LEARNING_TICK * TICKS_PER_LEARNING_TICK
    return last * CONTROL_PERIOD_US // spacing_us + 1
