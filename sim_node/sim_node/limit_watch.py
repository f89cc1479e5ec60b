"""Watches a walk's limits, control tick by control tick."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from numba import njit
from numpy.typing import NDArray

from biped_common.timing import control_ticks
from msgs_json.end_cause import EndCause
from sim_node.contact import FloorContact
from sim_node.physics import Array
from sim_node.settings import LimitSettings

# A servo at this share of its limit counts as saturated.
_SATURATED = 0.999


@dataclass
class LimitCounts:
    """For how many control ticks in a row something has been the case."""

    unloaded: int = 0
    """No load on either foot."""
    saturated: int = 0
    """Some servo at its torque limit."""


class LimitWatch:
    """Says why a walk must end, if it must."""

    def __init__(
        self,
        limits: LimitSettings,
        velocity_limit_rad_s: float,
        torque_limits_nm: Array,
    ) -> None:
        """Take the limits; the torques are those that the servos can reach."""
        self._limits = limits
        self._velocity_limit_rad_s = velocity_limit_rad_s
        self._unloaded_ticks = _ticks(limits.unloaded_feet_s)
        self._saturated_ticks = _ticks(limits.torque_saturation_s)
        self._torque_marks = _SATURATED * torque_limits_nm

    def check(
        self,
        counts: LimitCounts,
        joints: Array,
        contact: FloorContact,
        zmp_error_m: float,
    ) -> EndCause | None:
        """Return why the walk ends with this control tick, the gravest cause first.

        Args:
            counts: of the walk, brought up to date here.
            joints: (36,) positions [rad], velocities [rad/s] and torques [N m].
            contact: with the floor.
            zmp_error_m: norm.
        """
        limits = self._limits
        finite, too_fast, saturated = _judge(
            joints, self._velocity_limit_rad_s, self._torque_marks
        )
        counts.unloaded = 0 if contact.loaded else counts.unloaded + 1
        counts.saturated = counts.saturated + 1 if saturated else 0
        if not (finite and math.isfinite(zmp_error_m)):
            return EndCause.PHYSICS_NAN
        if contact.penetration_m > limits.foot_penetration_m:
            return EndCause.FOOT_THROUGH_FLOOR
        if zmp_error_m >= limits.zmp_error_m:
            return EndCause.ZMP_ERROR
        if too_fast:
            return EndCause.JOINT_VELOCITY
        if counts.saturated >= self._saturated_ticks:
            return EndCause.TORQUE_SATURATION
        if counts.unloaded >= self._unloaded_ticks:
            return EndCause.FEET_UNLOADED
        return None


@njit("UniTuple(boolean, 3)(float64[::1], float64, float64[::1])", cache=True)
def _judge(
    joints: NDArray[Any], velocity_limit: float, torque_marks: NDArray[Any]
) -> tuple[bool, bool, bool]:
    """Return whether all is finite, some joint too fast, some servo saturated."""
    n = len(torque_marks)
    finite, too_fast, saturated = True, False, False
    for value in joints:
        finite = finite and math.isfinite(value)
    for i in range(n):
        too_fast = too_fast or abs(joints[n + i]) >= velocity_limit
        saturated = saturated or abs(joints[2 * n + i]) >= torque_marks[i]
    return finite, too_fast, saturated


def _ticks(duration_s: float) -> int:
    return max(1, control_ticks(duration_s))
