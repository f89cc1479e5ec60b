"""What the joints are asked to do: a waist segment, solved for the legs."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from biped_common.timing import CONTROL_PERIOD_S
from biped_description import kernels
from biped_description.joints import JOINT_NAMES
from biped_description.robot import Robot
from msgs_json.segment import WaistSegment
from sim_node.physics import Array

_NO_MOTION = np.empty((0, len(JOINT_NAMES)))

PlannedPhase = tuple[bool, bool, int]
"""The gait's phase at one control tick: right support, double support, step index."""


class JointReferences(NamedTuple):
    """A segment with the joint motion that follows it, row by row."""

    segment: WaistSegment
    rows: int
    """Rows that the legs can reach, from the first on."""
    q: Array
    """(rows, 12) [rad]"""
    dq: Array
    """(rows - 1, 12) from each row to the next [rad/s]"""
    zmp: list[list[float]]
    """(rows, 2) [m]"""

    def phase(self, row: int) -> PlannedPhase:
        """Return the gait's phase at a row."""
        segment = self.segment
        return (
            bool(segment.right_support[row]),
            bool(segment.double_support[row]),
            int(segment.step_index[row]),
        )


def standing(start: WaistSegment) -> JointReferences:
    """Return references that hold a stance and lead nowhere."""
    zmp = start.zmp_reference[:1].tolist()
    return JointReferences(start, rows=1, q=_NO_MOTION, dq=_NO_MOTION, zmp=zmp)


def solve(
    robot: Robot, segment: WaistSegment, rows: int
) -> tuple[JointReferences, int]:
    """Return the references of a segment as far as the legs can follow it.

    Args:
        robot: whose legs follow.
        segment: C-contiguous float64 arrays.
        rows: how many of its rows to use.

    Returns:
        The references, and the status of `Robot.leg_motion`.

    Raises:
        ValueError: a number of the segment is not finite.
    """
    motion = robot.leg_motion(
        segment.waist[:rows],
        segment.left_foot[:rows],
        segment.right_foot[:rows],
        CONTROL_PERIOD_S,
    )
    zmp = segment.zmp_reference[:rows].tolist()
    if motion.status == kernels.NOT_FINITE:
        raise ValueError(f"segment has a pose that is not finite, row {motion.row}")
    # A sum is finite only if all of its terms are.
    if not math.isfinite(sum(map(sum, zmp))):
        raise ValueError("segment has a ZMP reference that is not finite")
    references = JointReferences(
        segment,
        rows=rows if motion.status == kernels.SOLVED else motion.row,
        q=motion.q,
        dq=motion.dq,
        zmp=zmp,
    )
    return references, motion.status
