"""What a viewer needs to see the walk: markers on the floor, and where the torso is.

Feet are drawn where the reference puts them, on the soles that were measured to carry
load; ZMP, waist and torso are drawn where they were measured.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
from visualization_msgs.msg import Marker

from biped_description.settings import RobotSettings
from biped_ros.guarded import GuardedNode
from biped_ros.markers import (
    CLEAR,
    MarkerForm,
    marker_array_template,
    torso_pose_template,
)
from msgs_json import topics
from msgs_json.segment import WaistSegment
from sim_node.control_tick import ControlTick
from sim_node.physics import Physics

Point = tuple[float, float]

TORSO_FRAME = "torso"
_WALKED_POINTS = 50
"""Of the waist's way so far, 2 s at 25 Hz."""
_PLANNED_POINTS = 13
"""Of the waist's way ahead, evenly spaced over the segment."""
_LINE_M = (0.004, 0.0, 0.0)
_DOT_M = (0.016, 0.016, 0.016)
_GREEN, _RED, _BLUE = (0.1, 0.7, 0.2, 1.0), (0.9, 0.1, 0.1, 1.0), (0.1, 0.3, 0.9, 1.0)
_PALE_BLUE, _ORANGE, _GREY = (
    (*_BLUE[:3], 0.2),
    (0.9, 0.5, 0.1, 1.0),
    (0.4,) * 3 + (1.0,),
)


def support_polygon(robot: RobotSettings, feet: Sequence[Point]) -> list[Point]:
    """Return the corners of the convex hull of soles, anticlockwise.

    Args:
        robot: dimensions of its soles.
        feet: (x, y) of none, one or both feet, which point ahead, world frame [m].

    Returns:
        None, four or six corners; of the six some may lie on one line or coincide.
    """
    if not feet:
        return []
    half_x, half_y = robot.sole_length_m / 2, robot.sole_width_m / 2
    soles = [
        ((x - half_x, y - half_y), (x + half_x, y - half_y),
         (x + half_x, y + half_y), (x - half_x, y + half_y))
        for x, y in sorted((x + robot.sole_ahead_of_ankle_m, y) for x, y in feet)
    ]  # fmt: skip
    if len(soles) == 1:
        return list(soles[0])
    rear, front = soles
    if rear[0][1] <= front[0][1]:  # the front sole is the left one
        return [rear[0], rear[1], front[1], front[2], front[3], rear[3]]
    return [rear[0], front[0], front[1], front[2], rear[2], rear[3]]


class MarkerPublisher:
    """Publishes markers and torso pose at every n-th control tick of a walk."""

    def __init__(
        self,
        node: GuardedNode,
        robot: RobotSettings,
        zmp_limit_m: float,
        every_ticks: int,
    ) -> None:
        """Make the publishers on a node.

        Args:
            node: that publishes.
            robot: whose soles are drawn.
            zmp_limit_m: norm of the ZMP error that is a failure.
            every_ticks: control ticks between two messages; 0: never.
        """
        self.every_ticks = every_ticks
        self._robot = robot
        self._markers = node.publisher(topics.MARKERS)
        self._torso = node.publisher(topics.TORSO_POSE)
        self._templates = {
            corners: marker_array_template(_forms(corners, zmp_limit_m))
            for corners in (0, 4, 6)
        }
        self._clear = marker_array_template([CLEAR])
        self._torso_template = torso_pose_template(TORSO_FRAME)
        self._walked: deque[tuple[float, ...]] = deque(maxlen=_WALKED_POINTS)
        self._last_tick = 0

    def publish(self, tick: ControlTick, segment: WaistSegment, world: Physics) -> None:
        """Publish what there is to see at a control tick, if it is its turn.

        Args:
            tick: just walked.
            segment: that was followed in it.
            world: in which it was walked.
        """
        at = tick.clock_ticks
        if self.every_ticks == 0 or at % self.every_ticks:
            return
        position, orientation = world.waist().position, world.torso_orientation()
        if not self._walked or tick.control_tick < self._last_tick:
            # Another walk: nothing of the last one stays in view.
            self._markers.publish(self._clear.fill((0.0,) * 3, at))
            self._walked.extend([position] * _WALKED_POINTS)
        self._last_tick = tick.control_tick
        self._walked.append(position)
        self._torso.publish(self._torso_template.fill((*position, *orientation), at))
        row = tick.control_tick - segment.first_tick
        contact = tick.contact
        loaded = [
            (float(foot[row, 0]), float(foot[row, 1]))
            for foot, load in (
                (segment.left_foot, contact.left_load_n),
                (segment.right_foot, contact.right_load_n),
            )
            if load > 0.0
        ]
        corners = support_polygon(self._robot, loaded)
        ahead = np.linspace(0, len(segment.waist) - 1, _PLANNED_POINTS, dtype=np.int64)
        origin = (0.0, 0.0, 0.0)
        reference = (*tick.zmp_reference, 0.0)
        values = np.concatenate(
            [
                np.ravel([origin, *((x, y, 0.0) for x, y in corners + corners[:1])]),
                (contact.zmp_x_m, contact.zmp_y_m, 0.0),
                reference,
                reference,
                origin,
                segment.waist[ahead].ravel(),
                np.ravel([origin, *self._walked]),
            ]
        )
        self._markers.publish(self._templates[len(corners)].fill(values, at))


def _forms(corners: int, zmp_limit_m: float) -> list[MarkerForm]:
    """Return the markers, in the order of their values."""
    return [
        MarkerForm(
            "support_polygon",
            Marker.LINE_STRIP,
            _LINE_M,
            _GREEN,
            points=corners + 1 if corners else 0,
            action=Marker.ADD if corners else Marker.DELETE,
        ),
        MarkerForm("zmp", Marker.SPHERE, _DOT_M, _RED),
        MarkerForm("zmp_reference", Marker.SPHERE, _DOT_M, _BLUE),
        MarkerForm(
            "zmp_limit",
            Marker.CYLINDER,
            (2.0 * zmp_limit_m, 2.0 * zmp_limit_m, 0.001),
            _PALE_BLUE,
        ),
        MarkerForm(
            "waist_planned", Marker.LINE_STRIP, _LINE_M, _ORANGE, points=_PLANNED_POINTS
        ),
        MarkerForm("waist_walked", Marker.POINTS, _DOT_M, _GREY, points=_WALKED_POINTS),
    ]
