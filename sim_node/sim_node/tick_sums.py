"""What an observation makes of the control ticks since the one before."""

from __future__ import annotations

import math
import struct
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from biped_common.timing import CONTROL_PERIOD_S

_N_JOINTS = 12
# Columns of a row: positions, velocities and torques of the joints, their references,
# the measured ZMP (2) and the norm of its error.
_DQ, _TORQUE, _Q_REFERENCE, _DQ_REFERENCE = 12, 24, 36, 48
_ZMP_ERROR, _COLUMNS = 62, 63
packed_row = struct.Struct(f"{_COLUMNS}d").pack
"""Packs the numbers of one control tick; beats every way of numpy for so few."""


class TickSums(NamedTuple):
    """Worst values, cost increments and last errors; see `Observation`."""

    worst_zmp_error_m: float = 0.0
    worst_joint_velocity_rad_s: float = 0.0
    zmp_error_integral_m2_s2: float = 0.0
    joint_error_integral_rad2_s: float = 0.0
    torque_integral_n2m2_s: float = 0.0
    mean_joint_error_rad: float = 0.0
    mean_joint_velocity_error_rad_s: float = 0.0


def sum_up(rows: list[bytes], last_tick: int, trajectory: Any) -> TickSums:
    """Sum up consecutive control ticks; none at all, or a NaN among them, gives zeros.

    Args:
        rows: control ticks of one walk, in order, as `packed_row` packs them.
        last_tick: number of the last of them in its walk.
        trajectory: hash (hashlib) that takes in all that was measured or asked for.
    """
    if not rows:
        return TickSums()
    packed = b"".join(rows)
    trajectory.update(packed)
    first_tick = last_tick - len(rows) + 1
    sums = TickSums._make(_sums(np.frombuffer(packed), first_tick))
    return sums if math.isfinite(sum(sums)) else TickSums()


@njit("UniTuple(float64, 7)(Array(float64, 1, 'C', readonly=True), int64)", cache=True)
def _sums(numbers: NDArray[Any], first_tick: int) -> tuple[float, ...]:
    """Return the fields of `TickSums`, in order.

    Args:
        numbers: those of n rows, one after the other.
        first_tick: number of the first control tick in its walk.
    """
    rows = numbers.reshape((-1, _COLUMNS))
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
