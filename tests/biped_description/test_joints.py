"""Order and limits of the joints."""

import numpy as np
import pytest

from biped_description.joints import (
    JOINT_NAMES,
    POSITION_LOWER,
    POSITION_UPPER,
    TORQUE_LIMIT,
)

LIMITS = {"lower": POSITION_LOWER, "upper": POSITION_UPPER, "torque": TORQUE_LIMIT}


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


@pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS.keys())
def test_both_legs_have_the_same_limits(limits):
    np.testing.assert_array_equal(limits[:6], limits[6:])


@pytest.mark.parametrize("limits", LIMITS.values(), ids=LIMITS.keys())
def test_limits_cannot_be_changed(limits):
    with pytest.raises(ValueError, match="read-only"):
        limits[0] = 0.0
