"""The control ticks since the last observation, and what the next one makes of them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from biped_common.timing import CONTROL_PERIOD_S
from sim_node.physics import Array

_N_JOINTS = 12
# Columns of a row: positions, velocities and torques of the joints, their references,
# the measured ZMP (2) and the norm of its error.
_DQ, _TORQUE, _Q_REFERENCE, _DQ_REFERENCE = 12, 24, 36, 48
_ZMP, _ZMP_ERROR, _COLUMNS = 60, 62, 63
_CAPACITY = 64  # to begin with


class TickSums(NamedTuple):
    """Worst values, cost increments and last errors; see `Observation`."""

    worst_zmp_error_m: float = 0.0
    worst_joint_velocity_rad_s: float = 0.0
    zmp_error_integral_m2_s2: float = 0.0
    joint_error_integral_rad2_s: float = 0.0
    torque_integral_n2m2_s: float = 0.0
    mean_joint_error_rad: float = 0.0
    mean_joint_velocity_error_rad_s: float = 0.0


class TickRows:
    """What consecutive control ticks measured and were asked for, a row each."""

    def __init__(self) -> None:
        """Start without a tick."""
        self._numbers = np.zeros((_CAPACITY, _COLUMNS))
        self._n = 0

    def __len__(self) -> int:
        return self._n

    def clear(self) -> None:
        """Forget all ticks."""
        self._n = 0

    def joints(self, ticks: int) -> Array:
        """Return room for the joints' measurements of the next ticks.

        Returns:
            (ticks, 36) positions [rad], velocities [rad/s] and torques [N m].
        """
        end = self._n + ticks
        if end > len(self._numbers):
            grown = np.zeros((2 * end, _COLUMNS))
            grown[: self._n] = self._numbers[: self._n]
            self._numbers = grown
        return self._numbers[self._n : end, :_Q_REFERENCE]

    def add(
        self,
        q_reference: Array,
        dq_reference: Array,
        zmp: list[tuple[float, float, float]],
    ) -> None:
        """Add the ticks whose joints were measured, with what else there is of them.

        Args:
            q_reference: (ticks, 12) [rad].
            dq_reference: (ticks, 12) [rad/s].
            zmp: of each tick x, y and the norm of its error [m].
        """
        if zmp:
            added = self._numbers[self._n : self._n + len(zmp)]
            added[:, _Q_REFERENCE:_DQ_REFERENCE] = q_reference
            added[:, _DQ_REFERENCE:_ZMP] = dq_reference
            added[:, _ZMP:] = zmp
            self._n += len(zmp)

    def sum_up(self, last_tick: int, trajectory: Any) -> TickSums:
        """Sum up all ticks; none at all, or a NaN among them, gives zeros.

        Args:
            last_tick: number of the last of them in its walk.
            trajectory: hash (hashlib) that takes in all of their numbers.
        """
        if self._n == 0:
            return TickSums()
        rows = self._numbers[: self._n]
        trajectory.update(rows)
        sums = TickSums._make(_sums(rows, last_tick - self._n + 1))
        return sums if math.isfinite(sum(sums)) else TickSums()


@njit("UniTuple(float64, 7)(float64[:, ::1], int64)", cache=True)
def _sums(rows: NDArray[Any], first_tick: int) -> tuple[float, ...]:
    """Return the fields of `TickSums`, in order.

    Args:
        rows: (n, columns) numbers.
        first_tick: number of the first control tick in its walk.
    """
    n = len(rows)
    worst_zmp_error = worst_velocity = 0.0
    zmp_sum = q_sum = torque_sum = 0.0
    for row in range(n):
        error = rows[row, _ZMP_ERROR]
        worst_zmp_error = max(worst_zmp_error, error)
        zmp_sum += error**2 * (first_tick + row)
        for joint in range(_N_JOINTS):
            q_error = rows[row, _Q_REFERENCE + joint] - rows[row, joint]
            q_sum += q_error**2
            worst_velocity = max(worst_velocity, abs(rows[row, _DQ + joint]))
            torque_sum += rows[row, _TORQUE + joint] ** 2
    last = rows[n - 1]
    last_q_error = last_dq_error = 0.0
    for joint in range(_N_JOINTS):
        last_q_error += abs(last[_Q_REFERENCE + joint] - last[joint])
        last_dq_error += abs(last[_DQ_REFERENCE + joint] - last[_DQ + joint])
    return (
        worst_zmp_error,
        worst_velocity,
        zmp_sum * CONTROL_PERIOD_S**2,
        q_sum * CONTROL_PERIOD_S,
        torque_sum * CONTROL_PERIOD_S,
        last_q_error / _N_JOINTS,
        last_dq_error / _N_JOINTS,
    )
