"""What the joints are asked to do: a waist segment, solved for the legs."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from biped_common.timing import CONTROL_PERIOD_S
from biped_description import kernels
from biped_description.joints import JOINT_NAMES
from biped_description.robot import Robot
from msgs_json.segment import WaistSegment

PlannedPhase = tuple[bool, bool, int]
"""The gait's phase at one control tick: right support, double support, step index."""


@dataclass(frozen=True)
class JointReferences:
    """A segment with the joint motion that follows it, as plain numbers by row."""

    segment: WaistSegment
    rows: int
    """Rows that the legs can reach, from the first on."""
    q: list[list[float]]
    """(rows, 12) [rad]"""
    dq: list[list[float]]
    """(rows - 1, 12) from each row to the next [rad/s]"""
    zmp: list[list[float]]
    """(rows, 2) [m]"""
    phase: list[PlannedPhase]
    """(rows,)"""


def standing(start: WaistSegment) -> JointReferences:
    """Return references that hold a stance and lead nowhere."""
    zmp = start.zmp_reference[:1].tolist()
    return JointReferences(start, rows=1, q=[], dq=[], zmp=zmp, phase=_phases(start, 1))


def solve(
    robot: Robot, segment: WaistSegment, rows: int
) -> tuple[JointReferences, int]:
    """Return the references of a segment as far as the legs can follow it.

    Args:
        robot: whose legs follow.
        segment: C-contiguous float64 arrays.
        rows: how many of its rows to use.

    Returns:
        The references, and the status of `Robot.solve_legs`.

    Raises:
        ValueError: a number of the segment is not finite.
    """
    q = np.empty((rows, len(JOINT_NAMES)))
    status, row, _ = robot.solve_legs(
        segment.waist[:rows], segment.left_foot[:rows], segment.right_foot[:rows], q
    )
    zmp = segment.zmp_reference[:rows]
    if status == kernels.NOT_FINITE:
        raise ValueError(f"segment has a pose that is not finite, row {row}")
    # A sum is finite only if all of its terms are.
    if not math.isfinite(zmp.sum()):
        raise ValueError("segment has a ZMP reference that is not finite")
    references = JointReferences(
        segment,
        rows=rows if status == kernels.SOLVED else row,
        q=q.tolist(),
        dq=((q[1:] - q[:-1]) / CONTROL_PERIOD_S).tolist(),
        zmp=zmp.tolist(),
        phase=_phases(segment, rows),
    )
    return references, status


def _phases(segment: WaistSegment, rows: int) -> list[PlannedPhase]:
    return list(
        zip(
            segment.right_support[:rows].tolist(),
            segment.double_support[:rows].tolist(),
            segment.step_index[:rows].tolist(),
            strict=True,
        )
    )
