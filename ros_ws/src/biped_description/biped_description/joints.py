"""The twelve joints: names, order, axes and limits.

Every array of joint quantities in the project has this order: left leg, then right,
each from the hip down. Joint positions are zero when the robot stands straight, and
turn by the right-hand rule about the axis given here, so that a flexed knee is
positive and a thigh swung forward has a negative hip pitch.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

LEGS: Final = ("left", "right")
JOINTS_PER_LEG: Final = 6


class LegJoint(NamedTuple):
    """One joint of a leg; left and right are alike."""

    name: str
    axis: tuple[int, int, int]  # in the frame of the parent link
    position_lower: float  # [rad]
    position_upper: float  # [rad]
    torque_limit: float  # [N m]


LEG_JOINTS: Final = (
    LegJoint("hip_yaw", (0, 0, 1), -0.8, 0.8, 40.0),
    LegJoint("hip_roll", (1, 0, 0), -0.6, 0.6, 80.0),
    LegJoint("hip_pitch", (0, 1, 0), -1.6, 0.8, 80.0),
    LegJoint("knee", (0, 1, 0), 0.0, 2.2, 100.0),
    LegJoint("ankle_pitch", (0, 1, 0), -1.2, 1.2, 80.0),
    LegJoint("ankle_roll", (1, 0, 0), -0.6, 0.6, 60.0),
)

# Index of a joint within its leg.
HIP_YAW, HIP_ROLL, HIP_PITCH, KNEE, ANKLE_PITCH, ANKLE_ROLL = range(JOINTS_PER_LEG)


def _both_legs(values: list[float]) -> NDArray[np.float64]:
    """Repeat the six values of a leg for both legs, in a read-only array."""
    array = np.array(2 * values, dtype=np.float64)
    array.flags.writeable = False
    return array


JOINT_NAMES: Final = tuple(f"{leg}_{each.name}" for leg in LEGS for each in LEG_JOINTS)

# (12,) limits of joint positions [rad] and torques [N m], in the order of JOINT_NAMES.
POSITION_LOWER: Final = _both_legs([each.position_lower for each in LEG_JOINTS])
POSITION_UPPER: Final = _both_legs([each.position_upper for each in LEG_JOINTS])
TORQUE_LIMIT: Final = _both_legs([each.torque_limit for each in LEG_JOINTS])

# Limit of every joint's velocity [rad/s], 600 revolutions per minute.
VELOCITY_LIMIT: Final = 20.0 * np.pi
