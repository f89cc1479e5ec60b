"""What one control tick measures, and what a learning tick makes of ten of them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from msgs_json.timing import CONTROL_PERIOD_S
from sim_node.contact import FloorContact


class ControlTick(NamedTuple):
    """All that one control tick measured, for whoever listens at 500 Hz."""

    control_tick: int
    joint_reference: list[float]
    """(12,) [rad]"""
    joint_position: tuple[float, ...]
    """(12,) [rad]"""
    joint_velocity: tuple[float, ...]
    """(12,) [rad/s]"""
    joint_torque: tuple[float, ...]
    """(12,) [N m]"""
    contact: FloorContact
    zmp_error_m: float
    """Norm of measured minus reference ZMP."""


class TickSums(NamedTuple):
    """Worst values, cost increments and last errors; see `Observation`."""

    worst_zmp_error_m: float = 0.0
    worst_joint_velocity_rad_s: float = 0.0
    zmp_error_integral_m2_s2: float = 0.0
    joint_error_integral_rad2_s: float = 0.0
    torque_integral_n2m2_s: float = 0.0
    mean_joint_error_rad: float = 0.0
    mean_joint_velocity_error_rad_s: float = 0.0


def sum_up(
    ticks: list[ControlTick], q_reference: NDArray[np.float64], trajectory: Any
) -> TickSums:
    """Sum up the control ticks of one learning tick; none at all gives zeros.

    Args:
        ticks: n measured control ticks.
        q_reference: (at least n + 1, 12) references; tick i went from row i to i + 1.
        trajectory: hash (hashlib) that takes in all that was measured.
    """
    n = len(ticks)
    if n == 0:
        return TickSums()
    q = np.array([tick.joint_position for tick in ticks])
    dq = np.array([tick.joint_velocity for tick in ticks])
    torque = np.array([tick.joint_torque for tick in ticks])
    zmp = np.array([tick.contact[:2] for tick in ticks])
    for measured in (q, dq, torque, zmp):
        trajectory.update(measured.tobytes())
    q_error = q_reference[1 : n + 1] - q
    dq_reference = (q_reference[n] - q_reference[n - 1]) / CONTROL_PERIOD_S
    return TickSums(
        worst_zmp_error_m=max(tick.zmp_error_m for tick in ticks),
        worst_joint_velocity_rad_s=float(np.abs(dq).max()),
        zmp_error_integral_m2_s2=sum(
            tick.zmp_error_m**2 * tick.control_tick * CONTROL_PERIOD_S**2
            for tick in ticks
        ),
        joint_error_integral_rad2_s=float((q_error**2).sum() * CONTROL_PERIOD_S),
        torque_integral_n2m2_s=float((torque**2).sum() * CONTROL_PERIOD_S),
        mean_joint_error_rad=float(np.abs(q_error[-1]).mean()),
        mean_joint_velocity_error_rad_s=float(np.abs(dq_reference - dq[-1]).mean()),
    )
