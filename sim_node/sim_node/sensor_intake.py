"""Makes readings of the sensors' messages: one of each topic, of the same update.

All broadcasters of one controller manager stamp the messages of one update alike; which
of them arrives first is the middleware's business. A stamp before time 0 is of none.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from biped_common.timing import nanoseconds
from biped_description.joints import JOINT_NAMES
from sim_node.physics import Array
from sim_node.sensors import SensorReading

_JOINTS, _IMU, _LEFT, _RIGHT = range(4)
_N_JOINTS = len(JOINT_NAMES)


class SensorIntake:
    """The newest complete reading, and how many there have been."""

    def __init__(self) -> None:
        """Begin without a message."""
        self.newest: SensorReading | None = None
        self.complete = 0
        """Readings that were complete."""
        self.stamp_ns = 0
        """Of the newest one."""
        self._stamps: list[int | None] = [None] * 4
        self._joints = np.empty(3 * _N_JOINTS)
        self._imu = np.empty(4), np.empty(3)
        self._soles = np.empty((2, 3))

    def joint_states(self, message: Any) -> None:
        """Take in a sensor_msgs/JointState; what it lacks is NaN."""
        place = {name: i for i, name in enumerate(message.name)}
        rows = [
            [_at(values, place.get(name, -1)) for name in JOINT_NAMES]
            for values in (message.position, message.velocity, message.effort)
        ]
        self._joints = np.ravel(np.array(rows, dtype=np.float64))
        self._arrived(_JOINTS, message)

    def imu(self, message: Any) -> None:
        """Take in a sensor_msgs/Imu."""
        q, a = message.orientation, message.linear_acceleration
        self._imu = np.array([q.x, q.y, q.z, q.w]), np.array([a.x, a.y, a.z])
        self._arrived(_IMU, message)

    def sole(self, side: int, message: Any) -> None:
        """Take in a geometry_msgs/WrenchStamped: side 0 left, 1 right."""
        wrench = message.wrench
        soles: Array = self._soles.copy()
        soles[side] = wrench.force.z, wrench.torque.x, wrench.torque.y
        self._soles = soles
        self._arrived((_LEFT, _RIGHT)[side], message)

    def _arrived(self, topic: int, message: Any) -> None:
        self._stamps[topic] = stamp_ns = nanoseconds(message.header.stamp)
        if stamp_ns >= 0 and len(set(self._stamps)) == 1:
            self.newest = SensorReading(self._joints, *self._imu, self._soles)
            self.stamp_ns = stamp_ns
            self.complete += 1


def _at(values: Any, place: int) -> float:
    return values[place] if 0 <= place < len(values) else math.nan
