"""The walk as planned, for references that come as bare positions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from msgs_json.segment import WaistSegment, segment_ticks
from msgs_json.walk_plan import WalkPlan
from msgs_json.wire import RefusedMessageError


class PlannedWalk:
    """Adds to references what the plan of the walk says of their control ticks."""

    def __init__(self, plan: WalkPlan) -> None:
        """Take over a plan.

        Raises:
            RefusedMessageError: its phases do not follow one another.
        """
        self.plan = plan
        begins = [phase.from_tick for phase in plan.phases]
        if begins[:1] != [0] or begins != sorted(set(begins)):
            raise RefusedMessageError(
                f"phases from ticks {begins}: must follow one another from 0"
            )
        try:
            self._begins = np.array(begins, dtype=np.int64)
            self._step_index = np.array(
                [phase.step_index for phase in plan.phases], dtype=np.int64
            )
        except OverflowError:
            raise RefusedMessageError("a phase with an endless number") from None
        self._right = np.array([phase.right_support for phase in plan.phases])
        self._double = np.array([phase.double_support for phase in plan.phases])
        positions = [
            plan.waist_m, plan.left_foot_m, plan.right_foot_m, (*plan.zmp_m, 0.0)
        ]  # fmt: skip
        self.stance = self._of(0, 0, np.array([positions]))
        """A segment of one row."""

    def segment(self, first_tick: int, positions: NDArray[np.float64]) -> WaistSegment:
        """Return the segment that starts at a control tick of the walk.

        Args:
            first_tick: of the segment.
            positions: (rows, 4, 3) of waist, left foot, right foot and reference ZMP
                in the world frame [m].

        Raises:
            RefusedMessageError: a number is not finite, there are too few rows for the
                ticks to be walked, or the walk is over.
        """
        if not np.isfinite(positions).all():
            raise RefusedMessageError("segment with a number that is not finite")
        n_ticks = segment_ticks(first_tick, self.plan.walk_ticks)
        if not 0 < n_ticks < len(positions):
            raise RefusedMessageError(
                f"segment of {len(positions)} rows from tick {first_tick}: "
                f"{n_ticks} ticks cannot be walked on it"
            )
        return self._of(first_tick, n_ticks, positions)

    def _of(
        self, first_tick: int, n_ticks: int, positions: NDArray[np.float64]
    ) -> WaistSegment:
        rows = first_tick + np.arange(len(positions))
        phase = np.searchsorted(self._begins, rows, side="right") - 1
        return WaistSegment(
            first_tick=first_tick,
            n_ticks=n_ticks,
            waist=np.ascontiguousarray(positions[:, 0]),
            left_foot=np.ascontiguousarray(positions[:, 1]),
            right_foot=np.ascontiguousarray(positions[:, 2]),
            zmp_reference=np.ascontiguousarray(positions[:, 3, :2]),
            right_support=self._right[phase],
            double_support=self._double[phase],
            step_index=self._step_index[phase],
        )
