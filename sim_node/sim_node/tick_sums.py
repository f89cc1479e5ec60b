"""What an observation makes of the control ticks since the one before."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from msgs_json.timing import CONTROL_PERIOD_S
from sim_node.control_tick import ControlTick

_N_JOINTS = 12


class TickSums(NamedTuple):
    """Worst values, cost increments and last errors; see `Observation`."""

    worst_zmp_error_m: float = 0.0
    worst_joint_velocity_rad_s: float = 0.0
    zmp_error_integral_m2_s2: float = 0.0
    joint_error_integral_rad2_s: float = 0.0
    torque_integral_n2m2_s: float = 0.0
    mean_joint_error_rad: float = 0.0
    mean_joint_velocity_error_rad_s: float = 0.0


def sum_up(ticks: list[ControlTick], trajectory: Any) -> TickSums:
    """Sum up consecutive control ticks; none at all, or a NaN among them, gives zeros.

    Args:
        ticks: n measured control ticks of one walk, in order.
        trajectory: hash (hashlib) that takes in all that was measured.
    """
    if not ticks:
        return TickSums()
    measured = _array(
        tick.joint_position + tick.joint_velocity + tick.joint_torque + tick.contact[:2]
        for tick in ticks
    )
    trajectory.update(measured)
    last = ticks[-1]
    sums = TickSums._make(
        _sums(
            measured,
            _array(tick.joint_reference for tick in ticks),
            np.array(last.joint_velocity_reference),
            np.array([tick.zmp_error_m for tick in ticks]),
            ticks[0].control_tick,
        )
    )
    return sums if math.isfinite(sum(sums)) else TickSums()


def _array(rows: Iterable[Sequence[float]]) -> NDArray[np.float64]:
    """Return an (n, m) array; a good deal faster than `np.array` for few rows."""
    rows = list(rows)
    flat = np.fromiter(chain.from_iterable(rows), float, len(rows) * len(rows[0]))
    return flat.reshape(len(rows), -1)


@njit(
    "UniTuple(float64, 7)"
    "(float64[:, ::1], float64[:, ::1], float64[::1], float64[::1], int64)",
    cache=True,
)
def _sums(
    measured: NDArray[Any],
    q_reference: NDArray[Any],
    last_dq_reference: NDArray[Any],
    zmp_error_m: NDArray[Any],
    first_tick: int,
) -> tuple[float, ...]:
    """Return the fields of `TickSums`, in order.

    Args:
        measured: (n, 38) joint positions, velocities, torques and ZMP.
        q_reference: (n, 12) [rad].
        last_dq_reference: (12,) of the last tick [rad/s].
        zmp_error_m: (n,).
        first_tick: number of the first control tick in its walk.
    """
    n = len(measured)
    worst_zmp_error = worst_velocity = 0.0
    zmp_sum = q_sum = torque_sum = 0.0
    for row in range(n):
        error = zmp_error_m[row]
        worst_zmp_error = max(worst_zmp_error, error)
        zmp_sum += error**2 * (first_tick + row)
        for joint in range(_N_JOINTS):
            q_error = q_reference[row, joint] - measured[row, joint]
            q_sum += q_error**2
            speed = abs(measured[row, _N_JOINTS + joint])
            worst_velocity = max(worst_velocity, speed)
            torque_sum += measured[row, 2 * _N_JOINTS + joint] ** 2
    last_q_error = last_dq_error = 0.0
    for joint in range(_N_JOINTS):
        last_q_error += abs(q_reference[n - 1, joint] - measured[n - 1, joint])
        last_dq_error += abs(
            last_dq_reference[joint] - measured[n - 1, _N_JOINTS + joint]
        )
    return (
        worst_zmp_error,
        worst_velocity,
        zmp_sum * CONTROL_PERIOD_S**2,
        q_sum * CONTROL_PERIOD_S,
        torque_sum * CONTROL_PERIOD_S,
        last_q_error / _N_JOINTS,
        last_dq_error / _N_JOINTS,
    )
