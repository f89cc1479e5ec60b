"""Watches a walk's limits, control tick by control tick."""

from __future__ import annotations

import math
import operator
from dataclasses import dataclass

from biped_common.timing import CONTROL_PERIOD_US, microseconds
from msgs_json.end_cause import EndCause
from sim_node.contact import FloorContact
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
        torque_limits_nm: list[float],
    ) -> None:
        """Take the limits; the torques are those that the servos can reach."""
        self._limits = limits
        self._velocity_limit_rad_s = velocity_limit_rad_s
        self._unloaded_ticks = _ticks(limits.unloaded_feet_s)
        self._saturated_ticks = _ticks(limits.torque_saturation_s)
        self._torque_marks = [_SATURATED * limit for limit in torque_limits_nm]
        self._lowest_mark = min(self._torque_marks)

    def check(
        self,
        counts: LimitCounts,
        position: tuple[float, ...],
        velocity: tuple[float, ...],
        torque: tuple[float, ...],
        contact: FloorContact,
        zmp_error_m: float,
    ) -> EndCause | None:
        """Return why the walk ends with this control tick, the gravest cause first.

        Args:
            counts: of the walk, brought up to date here.
            position: (12,) [rad].
            velocity: (12,) [rad/s].
            torque: (12,) [N m].
            contact: with the floor.
            zmp_error_m: norm.
        """
        limits = self._limits
        loaded = contact.left_load_n + contact.right_load_n > 0.0
        counts.unloaded = 0 if loaded else counts.unloaded + 1
        # A norm is finite only if all joints' values are, and none of them is larger:
        # mostly it settles what would else be asked of each.
        speed, effort = math.hypot(*velocity), math.hypot(*torque)
        saturated = effort >= self._lowest_mark and self._saturated(torque)
        counts.saturated = counts.saturated + 1 if saturated else 0
        if not math.isfinite(zmp_error_m + math.hypot(*position) + speed + effort):
            return EndCause.PHYSICS_NAN
        if contact.penetration_m > limits.foot_penetration_m:
            return EndCause.FOOT_THROUGH_FLOOR
        if zmp_error_m >= limits.zmp_error_m:
            return EndCause.ZMP_ERROR
        if (
            speed >= self._velocity_limit_rad_s
            and max(map(abs, velocity)) >= self._velocity_limit_rad_s
        ):
            return EndCause.JOINT_VELOCITY
        if counts.saturated >= self._saturated_ticks:
            return EndCause.TORQUE_SATURATION
        if counts.unloaded >= self._unloaded_ticks:
            return EndCause.FEET_UNLOADED
        return None

    def _saturated(self, torque: tuple[float, ...]) -> bool:
        return any(map(operator.ge, map(abs, torque), self._torque_marks))


def _ticks(duration_s: float) -> int:
    return max(1, microseconds(duration_s) // CONTROL_PERIOD_US)
