"""Makes readings of the sensors' messages: one of each topic, of the same update.

All broadcasters of one controller manager stamp the messages of one update alike; which
of them arrives first is the middleware's business, and those of one topic may be some
updates ahead of another's. A stamp before time 0 is of no update.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from biped_common.timing import nanoseconds
from biped_description.joints import JOINT_NAMES
from sim_node.physics import Array
from sim_node.sensors import SensorReading

_JOINTS, _ORIENTATION, _ACCELERATION, _LEFT, _RIGHT = range(5)
_KEPT_UPDATES = 1000


class SensorIntake:
    """The newest complete reading, and how many there have been."""

    def __init__(self) -> None:
        """Begin without a message."""
        self.newest: SensorReading | None = None
        self.complete = 0
        """Readings that were complete."""
        self.stamp_ns = 0
        """Of the newest one."""
        self._updates: dict[int, dict[int, Array]] = {}
        """What has come of each update that is not complete, by its stamp [ns]."""

    def joint_states(self, message: Any) -> None:
        """Take in a sensor_msgs/JointState; what it lacks is NaN."""
        place = {name: i for i, name in enumerate(message.name)}
        rows = [
            [_at(values, place.get(name, -1)) for name in JOINT_NAMES]
            for values in (message.position, message.velocity, message.effort)
        ]
        self._arrived(message, {_JOINTS: np.ravel(np.array(rows, dtype=np.float64))})

    def imu(self, message: Any) -> None:
        """Take in a sensor_msgs/Imu."""
        q, a = message.orientation, message.linear_acceleration
        orientation = np.array([q.x, q.y, q.z, q.w])
        acceleration = np.array([a.x, a.y, a.z])
        self._arrived(message, {_ORIENTATION: orientation, _ACCELERATION: acceleration})

    def sole(self, side: int, message: Any) -> None:
        """Take in a geometry_msgs/WrenchStamped: side 0 left, 1 right."""
        wrench = message.wrench
        values = np.array([wrench.force.z, wrench.torque.x, wrench.torque.y])
        self._arrived(message, {(_LEFT, _RIGHT)[side]: values})

    def _arrived(self, message: Any, values: dict[int, Array]) -> None:
        stamp_ns = nanoseconds(message.header.stamp)
        if stamp_ns < 0:
            return
        parts = self._updates.setdefault(stamp_ns, {})
        parts |= values
        if len(parts) == 5:
            soles = np.array([parts[_LEFT], parts[_RIGHT]])
            self.newest = SensorReading(
                parts[_JOINTS], parts[_ORIENTATION], parts[_ACCELERATION], soles
            )
            self.stamp_ns = stamp_ns
            self.complete += 1
            # A topic keeps its order: what is not complete by now never will be.
            self._updates = {
                at: begun for at, begun in self._updates.items() if at > stamp_ns
            }
        elif len(self._updates) > _KEPT_UPDATES:
            del self._updates[min(self._updates)]


def _at(values: Any, place: int) -> float:
    return values[place] if 0 <= place < len(values) else math.nan
