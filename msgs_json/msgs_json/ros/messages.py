"""Templates of the graph's standard messages, and what their numbers mean."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from builtin_interfaces.msg import Duration
from geometry_msgs.msg import PointStamped, Transform, Vector3Stamped
from numpy.typing import NDArray
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from trajectory_msgs.msg import MultiDOFJointTrajectory, MultiDOFJointTrajectoryPoint

from msgs_json.refusal import RefusedMessageError
from msgs_json.ros.cdr import MessageTemplate
from msgs_json.segment import WaistSegment
from msgs_json.timing import CONTROL_PERIOD_US

WORLD_FRAME = "world"
# One transform each per control tick; only translations are used. `phase` holds flags:
# x 1 = right support leg, y 1 = double support, z = single supports begun. `extent`
# is the same in all rows: x = first control tick of the walk, y = ticks to be walked
# before the next observation; rows beyond them are look-ahead.
SEGMENT_PARTS = (
    "waist",
    "left_foot",
    "right_foot",
    "zmp_reference",
    "phase",
    "extent",
)
_AXES = 3


def clock_template() -> MessageTemplate:
    """Return /clock."""
    return MessageTemplate(lambda _: Clock(), 0, stamped=True)


def joint_state_template(
    names: Sequence[str], *, with_effort: bool
) -> MessageTemplate:
    """Return joint states: positions, velocities and, if asked for, efforts."""
    n = len(names)

    def make(values: Sequence[float]) -> JointState:
        message = JointState(name=list(names))
        message.position = values[:n]
        message.velocity = values[n : 2 * n]
        message.effort = values[2 * n :]
        return message

    return MessageTemplate(make, (3 if with_effort else 2) * n, stamped=True)


def point_template() -> MessageTemplate:
    """Return a point on the floor: x and y."""

    def make(values: Sequence[float]) -> PointStamped:
        message = PointStamped()
        message.header.frame_id = WORLD_FRAME
        message.point.x, message.point.y = values
        return message

    return MessageTemplate(make, 2, stamped=True)


def correction_template(instance: str) -> MessageTemplate:
    """Return a correction (dx, dy) of the learner that bears this name."""

    def make(values: Sequence[float]) -> Vector3Stamped:
        message = Vector3Stamped()
        message.header.frame_id = instance
        message.vector.x, message.vector.y = values
        return message

    return MessageTemplate(make, 2, stamped=True)


def segment_template(rows: int) -> MessageTemplate:
    """Return a waist segment of so many control ticks."""

    def make(values: Sequence[float]) -> MultiDOFJointTrajectory:
        cells = np.reshape(values, (rows, len(SEGMENT_PARTS), _AXES))
        message = MultiDOFJointTrajectory(joint_names=list(SEGMENT_PARTS))
        message.header.frame_id = WORLD_FRAME
        for row in range(rows):
            point = MultiDOFJointTrajectoryPoint()
            point.time_from_start = Duration(nanosec=row * CONTROL_PERIOD_US * 1000)
            for part in range(len(SEGMENT_PARTS)):
                transform = Transform()
                x, y, z = (float(v) for v in cells[row, part])
                transform.translation.x = x
                transform.translation.y = y
                transform.translation.z = z
                point.transforms.append(transform)
            message.points.append(point)
        return message

    return MessageTemplate(make, rows * len(SEGMENT_PARTS) * _AXES, stamped=True)


def segment_values(segment: WaistSegment) -> NDArray[np.float64]:
    """Return the (rows, parts, 3) numbers of a segment's message."""
    values = np.zeros((len(segment.waist), len(SEGMENT_PARTS), _AXES))
    values[:, 0] = segment.waist
    values[:, 1] = segment.left_foot
    values[:, 2] = segment.right_foot
    values[:, 3, :2] = segment.zmp_reference
    values[:, 4, 0] = segment.right_support
    values[:, 4, 1] = segment.double_support
    values[:, 4, 2] = segment.step_index
    values[:, 5, 0] = segment.first_tick
    values[:, 5, 1] = segment.n_ticks
    return values


def segment_of(values: NDArray[np.float64]) -> WaistSegment:
    """Return the segment of a message's numbers, the inverse of `segment_values`.

    Raises:
        RefusedMessageError: a number is not finite, or the extent makes no sense.
    """
    if not np.isfinite(values).all():
        raise RefusedMessageError("segment with a number that is not finite")
    cells = values.reshape(-1, len(SEGMENT_PARTS), _AXES)
    first_tick, n_ticks = (int(n) for n in cells[0, 5, :2])
    if first_tick < 0 or not 0 <= n_ticks < len(cells) + (n_ticks == 0):
        raise RefusedMessageError(
            f"segment of {len(cells)} rows from tick {first_tick}: "
            f"{n_ticks} ticks cannot be walked on it"
        )
    return WaistSegment(
        first_tick=first_tick,
        n_ticks=n_ticks,
        waist=np.ascontiguousarray(cells[:, 0]),
        left_foot=np.ascontiguousarray(cells[:, 1]),
        right_foot=np.ascontiguousarray(cells[:, 2]),
        zmp_reference=np.ascontiguousarray(cells[:, 3, :2]),
        right_support=cells[:, 4, 0] == 1.0,
        double_support=cells[:, 4, 1] == 1.0,
        step_index=cells[:, 4, 2].astype(np.int64),
    )
