"""The stretch of reference that the trajectory hands to the robot per learning tick."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import TICKS_PER_LEARNING_TICK


@dataclass(frozen=True)
class WaistSegment:
    """References at consecutive control ticks, world frame [m].

    Row 0 is the tick at which the segment starts; the robot is driven from row i to
    row i + 1, so n + 1 rows hold n ticks of motion. Rows past `n_ticks` are look-ahead.
    """

    first_tick: int
    n_ticks: int
    waist: NDArray[np.float64]
    """(rows, 3) middle of the hip line."""
    left_foot: NDArray[np.float64]
    """(rows, 3) point of the left sole under the ankle."""
    right_foot: NDArray[np.float64]
    """(rows, 3) point of the right sole under the ankle."""
    zmp_reference: NDArray[np.float64]
    """(rows, 2)"""
    right_support: NDArray[np.bool_]
    """(rows,) support leg; in double support the coming stance leg."""
    double_support: NDArray[np.bool_]
    """(rows,)"""
    step_index: NDArray[np.int64]
    """(rows,) single supports begun so far."""


def segment_ticks(first_tick: int, walk_ticks: int) -> int:
    """Return the control ticks from a segment's start to the next observation.

    A learning tick, but for the last segment of a walk, which can be shorter.
    """
    return min(TICKS_PER_LEARNING_TICK, walk_ticks - first_tick)
