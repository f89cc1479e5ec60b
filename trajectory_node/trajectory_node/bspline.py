"""Uniform B-spline and the waist correction built from the learner's actions.

With control points one learning tick apart, random actions of +-24 mm would ask for
about 100 m/s^2. Each action a_k, taken at t_k, therefore adds
`a_k (T / h) B((t - t_k) / h)` at once: the correction is the B-spline of knot spacing h
whose control points are the running mean of the actions (Section 4.2).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import float64, int64, njit
from numpy.typing import NDArray

from biped_common.bspline import uniform_bspline
from biped_common.timing import (
    CONTROL_PERIOD_S,
    LEARNING_PERIOD_S,
    TICKS_PER_LEARNING_TICK,
)
from trajectory_node.settings import CorrectionSettings

_COMPONENTS = 2


@njit(
    float64[:, ::1](float64[:, ::1], float64[:, ::1], float64[:, ::1], int64),
    cache=True,
)
def corrected_waist(
    waist: NDArray[Any], weights: NDArray[Any], history: NDArray[Any], newest: int
) -> NDArray[Any]:
    """Return the waist plus sum_m weights[:, m] * action of age m.

    Args:
        waist: (rows, 3) at consecutive control ticks [m].
        weights: (rows, length) per control tick and age of the action.
        history: (length, 2) ring of actions [m].
        newest: place of the action of age 0.

    Returns:
        (rows, 3) [m].
    """
    rows, length = weights.shape
    corrected = waist.copy()
    for row in range(rows):
        for c in range(history.shape[1]):
            correction = 0.0
            for age in range(length):
                place = newest - age if age <= newest else newest - age + length
                correction += weights[row, age] * history[place, c]
            corrected[row, c] += correction
    return corrected


class CorrectionSpline:
    """History of actions and the smooth waist correction that they make."""

    def __init__(self, settings: CorrectionSettings, rows: int) -> None:
        """Start with no correction.

        Args:
            settings: knot spacing and order.
            rows: control ticks to evaluate from each learning tick on.
        """
        h = settings.knot_spacing_s
        length = math.ceil(
            round(settings.order * h / LEARNING_PERIOD_S, 9)
        )  # older actions have no effect any more
        ticks = (
            np.arange(rows)[:, None] + TICKS_PER_LEARNING_TICK * np.arange(length)[None]
        )
        self._weights = (LEARNING_PERIOD_S / h) * uniform_bspline(
            ticks * CONTROL_PERIOD_S / h, settings.order
        )
        self._history = np.zeros((length, _COMPONENTS))
        self._newest = 0

    def reset(self) -> None:
        """Forget all actions."""
        self._history[:] = 0.0
        self._newest = 0

    def push(
        self, action_m: NDArray[np.float64], waist: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Take the action (dx, dy) of a learning tick; return the waist corrected.

        Args:
            action_m: (2,) [m].
            waist: (rows, 3) at consecutive control ticks from then on [m].

        Returns:
            (rows, 3) [m].
        """
        self._newest = (self._newest + 1) % len(self._history)
        self._history[self._newest] = action_m
        return corrected_waist(waist, self._weights, self._history, self._newest)

    def snapshot(self) -> NDArray[np.float64]:
        """Return the (length, 2) actions by age, newest first [m]."""
        ages = (self._newest - np.arange(len(self._history))) % len(self._history)
        return self._history[ages].copy()

    def restore(self, actions_m: NDArray[np.float64]) -> None:
        """Take over what `snapshot` returned."""
        if actions_m.shape != self._history.shape:
            raise ValueError(
                f"action history of shape {actions_m.shape}, "
                f"this spline keeps {self._history.shape}"
            )
        self._newest = len(self._history) - 1
        self._history[:] = actions_m[::-1]
