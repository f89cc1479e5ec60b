"""The twelve joints: names, order and axes, the same for a robot of any size.

Every array of joint quantities in the project has this order: left leg, then right,
each from the hip down. Joint positions are zero when the robot stands straight, and
turn by the right-hand rule about the axis given here, so that a flexed knee is
positive and a thigh swung forward has a negative hip pitch.
"""

from typing import Final, NamedTuple

LEGS: Final = ("left", "right")


class LegJoint(NamedTuple):
    """One joint of a leg; left and right are alike."""

    name: str
    axis: tuple[int, int, int]  # in the frame of the parent link


LEG_JOINTS: Final = (
    LegJoint("hip_yaw", (0, 0, 1)),
    LegJoint("hip_roll", (1, 0, 0)),
    LegJoint("hip_pitch", (0, 1, 0)),
    LegJoint("knee", (0, 1, 0)),
    LegJoint("ankle_pitch", (0, 1, 0)),
    LegJoint("ankle_roll", (1, 0, 0)),
)
JOINTS_PER_LEG: Final = len(LEG_JOINTS)

# Index of a joint within its leg.
HIP_YAW, HIP_ROLL, HIP_PITCH, KNEE, ANKLE_PITCH, ANKLE_ROLL = range(JOINTS_PER_LEG)

JOINT_NAMES: Final = tuple(f"{leg}_{each.name}" for leg in LEGS for each in LEG_JOINTS)
