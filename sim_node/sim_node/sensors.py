"""What the sensors of a biped read at one control tick: joints, IMU, soles.

Axes and signs as in ROS: joint states as a joint_state_broadcaster gives them, the IMU
as in REP 145, with the axes of the torso, a sole's wrench as the floor presses on it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sim_node.physics import Array


class SensorReading(NamedTuple):
    """One tick's readings. Nothing in them knows where in the world the robot is."""

    joints: Array
    """(36,) positions [rad], velocities [rad/s] and torques [N m]."""
    orientation: Array
    """(4,) torso to an upright frame of any heading, quaternion (x, y, z, w)."""
    acceleration: Array
    """(3,) specific force in the torso's axes [m/s^2]: g upwards at rest."""
    soles: Array
    """(2, 3) left and right sole: force along z [N], moments about x and y [N m], in
    the foot's axes at the point of the sole under the ankle."""

    @property
    def usable(self) -> bool:
        """Whether every number is one, and the orientation is a rotation."""
        finite = all(math.isfinite(part.sum()) for part in self)
        return finite and abs(float(self.orientation @ self.orientation) - 1.0) < 0.1
