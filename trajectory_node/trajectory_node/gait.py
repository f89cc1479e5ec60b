"""The planned walk: feet, support flags and reference ZMP at every control tick.

Stand, shift over the left foot, single supports (the right foot swings first) joined by
double supports, shift back to the middle after the feet have closed, stand. In single
support the reference ZMP rests at the centre of the support sole; in double support
and in the shifts it moves there by a quintic, which starts and ends at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import CONTROL_PERIOD_US, TICKS_PER_LEARNING_TICK, microseconds
from biped_description.settings import RobotSettings
from msgs_json.walk_plan import GaitPhase
from trajectory_node.settings import LONGEST_LOOK_AHEAD_TICKS, GaitSettings


@dataclass(frozen=True)
class GaitPlan:
    """The walk, one row per control tick, world frame [m].

    Row i belongs to time i * 2 ms. Rows past `ticks` repeat the final stance.
    """

    ticks: int
    """Control ticks of the whole walk."""
    left_foot: NDArray[np.float64]
    """(rows, 3) point of the left sole under the ankle."""
    right_foot: NDArray[np.float64]
    """(rows, 3) point of the right sole under the ankle."""
    zmp_reference: NDArray[np.float64]
    """(rows, 2)"""
    right_support: NDArray[np.bool_]
    """(rows,) in double support the coming stance leg; at the end the last one."""
    double_support: NDArray[np.bool_]
    """(rows,)"""
    step_index: NDArray[np.int64]
    """(rows,) single supports begun so far."""

    def phases(self) -> tuple[GaitPhase, ...]:
        """Return the stretches of the walk in which the planned support is the same."""
        flags = np.column_stack(
            (self.right_support, self.double_support, self.step_index)
        )
        changed = (flags[1:] != flags[:-1]).any(axis=1)
        return tuple(
            GaitPhase(
                from_tick=int(tick),
                right_support=bool(self.right_support[tick]),
                double_support=bool(self.double_support[tick]),
                step_index=int(self.step_index[tick]),
            )
            for tick in (0, *(np.flatnonzero(changed) + 1))
        )


def quintic(s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the minimum-jerk blend from 0 to 1, clamped outside 0 <= s <= 1."""
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10.0 + s * (6.0 * s - 15.0))


def swing_bump(s: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a bump of height 1 at s = 1/2 that leaves and lands without a jolt."""
    s = np.clip(s, 0.0, 1.0)
    return (4.0 * s * (1.0 - s)) ** 3


def plan_gait(settings: GaitSettings, robot: RobotSettings) -> GaitPlan:
    """Lay out the walk that the settings describe, for a robot of these dimensions.

    Events are compared in whole microseconds, since T_step = 1.875 s is not a whole
    number of control ticks.
    """
    ticks = settings.walk_ticks
    rows = ticks + TICKS_PER_LEARNING_TICK + LONGEST_LOOK_AHEAD_TICKS
    time_us = np.arange(rows) * CONTROL_PERIOD_US
    single_us = microseconds(settings.single_support_s)
    double_us = microseconds(settings.double_support_s)
    length = settings.step_length_m
    foothold_x = {"left": 0.0, "right": 0.0}
    feet = {
        side: np.tile((0.0, sign * robot.half_hip_spacing_m, 0.0), (len(time_us), 1))
        for side, sign in (("left", 1.0), ("right", -1.0))
    }

    def progress(start_us: int, duration_us: int) -> NDArray[np.float64]:
        return (time_us - start_us) / duration_us

    def sole_centre(side: str) -> NDArray[np.float64]:
        y = robot.half_hip_spacing_m * (1.0 if side == "left" else -1.0)
        return np.array([foothold_x[side] + robot.sole_ahead_of_ankle_m, y])

    zmp_at = np.array([robot.sole_ahead_of_ankle_m, 0.0])
    zmp = np.tile(zmp_at, (len(time_us), 1))
    right_support = np.zeros(len(time_us), dtype=np.bool_)
    double_support = np.ones(len(time_us), dtype=np.bool_)
    step_index = np.zeros(len(time_us), dtype=np.int64)

    def move_zmp(target: NDArray[np.float64], start_us: int) -> None:
        nonlocal zmp_at
        blend = quintic(progress(start_us, double_us))
        zmp[:] += blend[:, None] * (target - zmp_at)
        zmp_at = target

    now_us = microseconds(settings.stand_s)
    for step in range(settings.steps):
        stance, swing = ("left", "right") if step % 2 == 0 else ("right", "left")
        # From here, the (double support before the) single support on `stance`.
        right_support[time_us >= now_us] = stance == "right"
        move_zmp(sole_centre(stance), now_us)
        now_us += double_us

        s = progress(now_us, single_us)
        in_single = (s >= 0.0) & (s < 1.0)
        double_support[in_single] = False
        step_index[time_us >= now_us] = step + 1
        closes = step == settings.steps - 1
        landing_x = foothold_x[stance] + (0.0 if closes and settings.steps > 1 else length)  # fmt: skip  # noqa: E501
        feet[swing][:, 0] += quintic(s) * (landing_x - foothold_x[swing])
        feet[swing][:, 2] += settings.swing_height_m * swing_bump(s)
        foothold_x[swing] = landing_x
        now_us += single_us
    move_zmp(0.5 * (sole_centre("left") + sole_centre("right")), now_us)
    return GaitPlan(
        ticks=ticks,
        left_foot=feet["left"],
        right_foot=feet["right"],
        zmp_reference=zmp,
        right_support=right_support,
        double_support=double_support,
        step_index=step_index,
    )
