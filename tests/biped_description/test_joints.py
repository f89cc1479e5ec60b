"""Order and limits of the joints."""

import pytest

from biped_description.joints import JOINT_NAMES

LIMITS = ["position_lower_rad", "position_upper_rad", "torque_limit_nm"]


def test_joints_go_down_the_left_leg_then_down_the_right():
    assert JOINT_NAMES == (
        "left_hip_yaw",
        "left_hip_roll",
        "left_hip_pitch",
        "left_knee",
        "left_ankle_pitch",
        "left_ankle_roll",
        "right_hip_yaw",
        "right_hip_roll",
        "right_hip_pitch",
        "right_knee",
        "right_ankle_pitch",
        "right_ankle_roll",
    )


@pytest.mark.parametrize("name", LIMITS)
def test_both_legs_have_the_limits_of_the_table(robot, name):
    limits = getattr(robot, name).tolist()
    assert limits[:6] == limits[6:] == list(getattr(robot.settings, name))


@pytest.mark.parametrize("name", [*LIMITS, "link_masses_kg"])
def test_what_a_robot_hands_out_cannot_be_changed(robot, name):
    with pytest.raises(ValueError, match="read-only"):
        getattr(robot, name)[0] = 0.0
