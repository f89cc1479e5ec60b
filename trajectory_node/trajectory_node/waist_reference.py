"""The reference motion: the static walk plus the learned waist correction."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import TICKS_PER_LEARNING_TICK
from biped_description.robot import Robot
from msgs_json.segment import WaistSegment, segment_ticks
from msgs_json.walk_plan import WalkPlan
from trajectory_node.bspline import CorrectionSpline
from trajectory_node.errors import TrajectoryError
from trajectory_node.gait import plan_gait
from trajectory_node.settings import (
    LONGEST_LOOK_AHEAD_TICKS,
    CorrectionSettings,
    GaitSettings,
)
from trajectory_node.static_waist import static_waist


class WaistReference:
    """Turns one correction per learning tick into one waist segment."""

    def __init__(
        self,
        robot: Robot,
        gait: GaitSettings,
        correction: CorrectionSettings,
        look_ahead_ticks: int = 1,
    ) -> None:
        """Plan the walk.

        Args:
            robot: that walks.
            gait: the walk.
            correction: the spline.
            look_ahead_ticks: rows handed out beyond the learning tick. One is needed
                for the velocity of the last control tick.

        Raises:
            InfeasibleGaitError: the robot cannot reach what the gait asks for.
        """
        if not 1 <= look_ahead_ticks <= LONGEST_LOOK_AHEAD_TICKS:
            raise TrajectoryError(
                f"look_ahead_ticks = {look_ahead_ticks}: "
                f"must be between 1 and {LONGEST_LOOK_AHEAD_TICKS}"
            )
        self.plan = plan_gait(gait, robot.settings)
        self.static_waist = static_waist(robot, self.plan, gait.waist_height_m)
        self.rows = TICKS_PER_LEARNING_TICK + look_ahead_ticks
        """Rows of every segment."""
        self._spline = CorrectionSpline(correction, self.rows)
        self._tick = 0

    @property
    def ticks(self) -> int:
        """Control ticks of the whole walk."""
        return self.plan.ticks

    @property
    def tick(self) -> int:
        """Control tick at which the next segment starts."""
        return self._tick

    def stance(self) -> WaistSegment:
        """Return the pose in which walks start, as a segment of one row."""
        plan = self.plan
        return WaistSegment(
            first_tick=0,
            n_ticks=0,
            waist=self.static_waist[:1],
            left_foot=plan.left_foot[:1],
            right_foot=plan.right_foot[:1],
            zmp_reference=plan.zmp_reference[:1],
            right_support=plan.right_support[:1],
            double_support=plan.double_support[:1],
            step_index=plan.step_index[:1],
        )

    def walk_plan(self) -> WalkPlan:
        """Return what is known of every walk before it begins."""
        plan = self.plan
        return WalkPlan(
            walk_ticks=plan.ticks,
            waist_m=tuple(self.static_waist[0].tolist()),
            left_foot_m=tuple(plan.left_foot[0].tolist()),
            right_foot_m=tuple(plan.right_foot[0].tolist()),
            zmp_m=tuple(plan.zmp_reference[0].tolist()),
            phases=plan.phases(),
        )

    def reset(self) -> None:
        """Go back to the start of the walk, without any correction."""
        self._tick = 0
        self._spline.reset()

    def segment(self, action_m: NDArray[np.float64]) -> WaistSegment:
        """Return the next segment, with the correction (dx, dy) applied from its start.

        The last segment of the walk can be shorter than a learning tick.

        Args:
            action_m: (2,) correction of this learning tick [m].

        Raises:
            TrajectoryError: the correction is not two finite numbers, or the walk is
                over.
        """
        if action_m.shape != (2,) or not math.isfinite(sum(action_m.tolist())):
            raise TrajectoryError(
                f"correction {action_m}: must be two finite numbers [m]"
            )
        if self._tick >= self.plan.ticks:
            raise TrajectoryError(f"the walk of {self.plan.ticks} ticks is over")
        first = self._tick
        rows = slice(first, first + self.rows)
        waist = self._spline.push(action_m, self.static_waist[rows])
        n_ticks = segment_ticks(first, self.plan.ticks)
        self._tick += n_ticks
        plan = self.plan
        return WaistSegment(
            first_tick=first,
            n_ticks=n_ticks,
            waist=waist,
            left_foot=plan.left_foot[rows],
            right_foot=plan.right_foot[rows],
            zmp_reference=plan.zmp_reference[rows],
            right_support=plan.right_support[rows],
            double_support=plan.double_support[rows],
            step_index=plan.step_index[rows],
        )

    def snapshot(self) -> dict[str, Any]:
        """Return what `restore` needs to go on from here."""
        return {"tick": self._tick, "actions_m": self._spline.snapshot()}

    def restore(self, snapshot: dict[str, Any]) -> None:
        """Go on from a snapshot of a reference with the same settings."""
        self._spline.restore(snapshot["actions_m"])
        self._tick = snapshot["tick"]
