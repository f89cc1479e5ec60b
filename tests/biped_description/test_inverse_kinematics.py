"""Joint positions from waist and feet, and what happens where there are none."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.robots import SHIPPED, TALL

from biped_description.errors import (
    DescriptionError,
    InvalidInputError,
    JointLimitError,
    UnreachablePoseError,
)
from biped_description.joints import JOINT_NAMES
from biped_description.kernels import (
    BEYOND_JOINT_LIMIT,
    NOT_FINITE,
    SOLVED,
    UNREACHABLE,
)
from biped_description.robot import Robot

DT = 0.002  # control tick [s]
HEIGHT_M = 0.475  # of the shipped robot's waist in its walking posture
MARGIN = 1e-6  # keeps drawn poses off the edge of the reachable set [rad]
untimed = settings(deadline=None)  # the first example may have to compile
coordinates = st.floats(-2.0, 2.0)  # [m]


def standing(ticks: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Waist, left and right foot (ticks, 3) in the walking posture."""
    waist = np.tile([0.0, 0.0, HEIGHT_M], (ticks, 1))
    left = np.tile([0.0, SHIPPED.settings.half_hip_spacing_m, 0.0], (ticks, 1))
    return waist, left, left * [1.0, -1.0, 1.0]


@st.composite
def flat_foot_legs(draw: st.DrawFn) -> list[float]:
    """Draw six joint positions within limits, yaw zero and foot flat."""
    roll = draw(st.floats(-0.6 + MARGIN, 0.6 - MARGIN))
    knee = draw(st.floats(MARGIN, 2.2 - MARGIN))
    lowest = max(-1.6, -1.2 - knee) + MARGIN
    highest = min(0.8, 1.2 - knee) - MARGIN
    pitch = draw(st.floats(lowest, highest))
    return [0.0, roll, pitch, knee, -pitch - knee, -roll]


@dataclass
class Pose:
    """Joint positions (1, 12) of a robot, and the pose (1, 3) each that they make."""

    robot: Robot
    q: np.ndarray
    waist: np.ndarray
    left_foot: np.ndarray
    right_foot: np.ndarray

    @property
    def found_q(self) -> np.ndarray:
        return self.robot.leg_joint_positions(
            self.waist, self.left_foot, self.right_foot
        )


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    """Draw a pose that a robot can take."""
    robot = draw(st.sampled_from([SHIPPED, TALL]))
    q = np.array([draw(flat_foot_legs()) + draw(flat_foot_legs())])
    waist = np.array([[draw(coordinates) for _ in range(3)]])
    left, right = robot.waist_to_feet(q)
    return Pose(robot, q, waist, waist + left, waist + right)


@untimed
@given(poses())
def test_the_feet_are_where_they_were_asked_to_be(pose):
    left, right = pose.robot.waist_to_feet(pose.found_q)
    np.testing.assert_allclose(pose.waist + left, pose.left_foot, rtol=0, atol=1e-9)
    np.testing.assert_allclose(pose.waist + right, pose.right_foot, rtol=0, atol=1e-9)


@untimed
@given(poses())
def test_the_feet_are_flat(pose):
    for rotation in pose.robot.foot_poses(pose.found_q)[1]:
        np.testing.assert_allclose(rotation[0], np.eye(3), rtol=0, atol=1e-9)


@untimed
@given(poses())
def test_joint_positions_are_found_again_from_the_feet(pose):
    # At a stretched knee the position answers with the root of the rounding error.
    np.testing.assert_allclose(pose.found_q, pose.q, rtol=0, atol=2e-6)


@untimed
@given(st.lists(st.floats(-0.5, 0.5), min_size=3, max_size=3))
def test_a_foot_is_reached_within_limits_or_refused_but_never_nearly(offset):
    waist, left_foot, right_foot = standing(1)
    left_foot = left_foot + offset
    try:
        q = SHIPPED.leg_joint_positions(waist, left_foot, right_foot)
    except (UnreachablePoseError, JointLimitError):
        return
    assert np.all((q >= SHIPPED.position_lower_rad) & (q <= SHIPPED.position_upper_rad))
    reached, _ = SHIPPED.waist_to_feet(q)
    np.testing.assert_allclose(waist + reached, left_foot, rtol=0, atol=1e-9)


def test_stretched_legs_are_all_zeros():
    waist, left, right = standing(1)
    waist[0, 2] = SHIPPED.settings.stretched_leg_length_m
    q = SHIPPED.leg_joint_positions(waist, left, right)
    np.testing.assert_allclose(q, np.zeros((1, 12)), rtol=0, atol=1e-6)


def test_many_ticks_give_the_same_as_one_at_a_time():
    waist, left, right = standing(20)
    waist[:, 0] += np.linspace(-0.1, 0.1, 20)
    right[:, 2] += np.linspace(0.0, 0.05, 20)
    rows = [
        SHIPPED.leg_joint_positions(*(each[i : i + 1] for each in (waist, left, right)))
        for i in range(20)
    ]
    together = SHIPPED.leg_joint_positions(waist, left, right)
    np.testing.assert_array_equal(together, np.vstack(rows))


def test_a_leg_that_is_too_short_is_named_with_tick_and_distance():
    waist, left, right = standing(5)
    right[3, 2] = -0.2
    message = r"tick 3: .* right leg are 0\.615 m apart, .* 0\.2177\d* to 0\.48 m"
    with pytest.raises(UnreachablePoseError, match=message):
        SHIPPED.leg_joint_positions(waist, left, right)


def test_a_knee_that_cannot_fold_so_far_is_refused():
    waist, left, right = standing(1)
    left[0, 2] = 0.3
    with pytest.raises(UnreachablePoseError, match=r"left leg are 0\.115 m apart"):
        SHIPPED.leg_joint_positions(waist, left, right)


@pytest.mark.parametrize(
    ("foot_offset", "joint", "position", "limits"),
    [
        ((0.00, 0.30, 0.115), "left_hip_roll", "0.785398", "-0.6 to 0.6"),
        ((0.25, 0.00, 0.215), "left_hip_pitch", "-1.73", "-1.6 to 0.8"),
        ((-0.30, 0.00, 0.115), "left_ankle_pitch", "-1.27", "-1.2 to 1.2"),
    ],
)
def test_a_joint_beyond_its_limit_is_named(foot_offset, joint, position, limits):
    waist, left, right = standing(4)
    left[2] += foot_offset
    message = rf"tick 2: {joint} at {position}\d* rad is outside {limits} rad"
    with pytest.raises(JointLimitError, match=message):
        SHIPPED.leg_joint_positions(waist, left, right)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("argument", [0, 1, 2])
def test_what_is_not_a_number_is_refused(argument, bad):
    pose = standing(3)
    pose[argument][1, 2] = bad
    with pytest.raises(InvalidInputError, match="tick 1"):
        SHIPPED.leg_joint_positions(*pose)


def test_feet_and_waist_must_have_as_many_ticks():
    waist, left, right = standing(3)
    with pytest.raises(InvalidInputError, match="right_foot has 2 ticks, waist 3"):
        SHIPPED.leg_joint_positions(waist, left, right[:2])


def test_a_single_position_is_refused_with_its_shape():
    waist, left, right = standing(3)
    with pytest.raises(InvalidInputError, match=r"waist must be \(n, 3\), got \(3,\)"):
        SHIPPED.leg_joint_positions(waist[0], left, right)


def moving(ticks: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Waist, left and right foot (ticks, 3) of a robot that leans forward."""
    waist, left, right = standing(ticks)
    waist[:, 0] += np.linspace(0.0, 0.05, ticks) ** 2
    return waist, left, right


def test_a_motion_has_the_positions_that_reach_its_poses():
    pose = moving(11)
    motion = SHIPPED.leg_motion(*pose, DT)
    np.testing.assert_array_equal(motion.q, SHIPPED.leg_joint_positions(*pose))


def test_a_motion_has_the_velocities_that_lead_from_row_to_row():
    motion = SHIPPED.leg_motion(*moving(11), DT)
    np.testing.assert_array_equal(motion.dq, np.diff(motion.q, axis=0) / DT)


def test_a_motion_says_when_all_went_well():
    motion = SHIPPED.leg_motion(*moving(11), DT)
    assert (motion.status, motion.row, motion.joint) == (SOLVED, -1, -1)


@pytest.mark.parametrize(
    ("foot_offset", "status", "joint"),
    [
        ((0.0, 0.0, -0.2), UNREACHABLE, "right_knee"),
        ((0.0, -0.3, 0.115), BEYOND_JOINT_LIMIT, "right_hip_roll"),
        ((np.nan, 0.0, 0.0), NOT_FINITE, "right_knee"),
    ],
)
def test_a_motion_reports_the_first_tick_that_fails(foot_offset, status, joint):
    waist, left, right = standing(11)
    right[[6, 9]] += foot_offset
    motion = SHIPPED.leg_motion(waist, left, right, DT)
    expected = status, 6, JOINT_NAMES.index(joint)
    assert (motion.status, motion.row, motion.joint) == expected


def test_a_motion_is_right_as_far_as_the_legs_can_follow():
    waist, left, right = moving(11)
    whole = SHIPPED.leg_motion(waist, left, right, DT)
    left[6, 2] = -0.2
    motion = SHIPPED.leg_motion(waist, left, right, DT)
    np.testing.assert_array_equal(motion.q[:6], whole.q[:6])
    np.testing.assert_array_equal(motion.dq[:5], whole.dq[:5])


def test_a_motion_of_arrays_of_unequal_length_is_refused():
    waist, left, right = standing(11)
    with pytest.raises(InvalidInputError, match=r"\(11, 3\), \(11, 3\) and \(6, 3\)"):
        SHIPPED.leg_motion(waist, left, right[:6], DT)


def test_a_distance_beyond_all_numbers_is_refused():
    waist, left, right = standing(1)
    waist[0, 0] = 1e300
    with pytest.raises(UnreachablePoseError, match="left leg are 1e\\+300 m apart"):
        SHIPPED.leg_joint_positions(waist, left, right)


@pytest.mark.parametrize(
    "error", [InvalidInputError, UnreachablePoseError, JointLimitError]
)
def test_every_error_is_a_description_error(error):
    assert issubclass(error, DescriptionError)
