"""What one control tick measures, and what a learning tick makes of ten of them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from msgs_json.observation import PhaseFlags
from msgs_json.timing import CONTROL_PERIOD_S
from sim_node.contact import FloorContact


class ControlTick(NamedTuple):
    """All that one control tick measured, for whoever listens at 500 Hz."""

    clock_ticks: int
    """Control ticks of the simulation's clock."""
    control_tick: int
    """Control ticks since the walk began."""
    joint_reference: list[float]
    """(12,) [rad]"""
    joint_velocity_reference: list[float]
    """(12,) [rad/s]"""
    joint_position: tuple[float, ...]
    """(12,) [rad]"""
    joint_velocity: tuple[float, ...]
    """(12,) [rad/s]"""
    joint_torque: tuple[float, ...]
    """(12,) [N m]"""
    contact: FloorContact
    zmp_reference: list[float]
    """(x, y) [m]"""
    zmp_error_m: float
    """Norm of measured minus reference ZMP."""
    phase: PhaseFlags


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
    """Sum up the control ticks of one learning tick; none at all gives zeros.

    Args:
        ticks: n measured control ticks.
        trajectory: hash (hashlib) that takes in all that was measured.
    """
    if not ticks:
        return TickSums()
    q = np.array([tick.joint_position for tick in ticks])
    dq = np.array([tick.joint_velocity for tick in ticks])
    torque = np.array([tick.joint_torque for tick in ticks])
    zmp = np.array([tick.contact[:2] for tick in ticks])
    for measured in (q, dq, torque, zmp):
        trajectory.update(measured.tobytes())
    q_error = np.array([tick.joint_reference for tick in ticks]) - q
    dq_error = np.subtract(ticks[-1].joint_velocity_reference, dq[-1])
    sums = TickSums(
        worst_zmp_error_m=max(tick.zmp_error_m for tick in ticks),
        worst_joint_velocity_rad_s=float(np.abs(dq).max()),
        zmp_error_integral_m2_s2=sum(
            tick.zmp_error_m**2 * tick.control_tick * CONTROL_PERIOD_S**2
            for tick in ticks
        ),
        joint_error_integral_rad2_s=float((q_error**2).sum() * CONTROL_PERIOD_S),
        torque_integral_n2m2_s=float((torque**2).sum() * CONTROL_PERIOD_S),
        mean_joint_error_rad=float(np.abs(q_error[-1]).mean()),
        mean_joint_velocity_error_rad_s=float(np.abs(dq_error).mean()),
    )
    return sums if all(map(math.isfinite, sums)) else TickSums()
