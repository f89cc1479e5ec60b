"""Trajectories of joints as they are followed, and those that are not."""

import math

import numpy as np
import pytest
from builtin_interfaces.msg import Duration, Time
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from biped_description.joints import JOINT_NAMES
from msgs_json.wire import RefusedMessageError
from sim_node.followed_trajectory import FollowedTrajectory

MS = 10**6


def message(rows, names=JOINT_NAMES, times_ms=None):
    """Points 2 ms apart, from 10 ms on."""
    times_ms = range(2, 2 * len(rows) + 1, 2) if times_ms is None else times_ms
    points = [
        JointTrajectoryPoint(
            positions=list(row), time_from_start=Duration(nanosec=at * MS)
        )
        for row, at in zip(rows, times_ms, strict=True)
    ]
    made = JointTrajectory(joint_names=list(names), points=points)
    made.header.stamp = Time(nanosec=10 * MS)
    return made


def followed(made, now_ms=10, position=0.0):
    return FollowedTrajectory(made, now_ms * MS, np.full(len(JOINT_NAMES), position))


def rows(*values):
    return [[value] * len(JOINT_NAMES) for value in values]


@pytest.mark.parametrize(
    ("at_ms", "position"),
    [(10, 0.0), (11, 0.5), (12, 1.0), (13, 1.5), (14, 2.0), (16, 4.0), (900, 4.0)],
)
def test_it_goes_straight_from_point_to_point_and_stays_at_the_last(at_ms, position):
    trajectory = followed(message(rows(1.0, 2.0, 4.0)))
    assert trajectory.at(at_ms * MS).tolist() == [position] * len(JOINT_NAMES)


def test_a_late_one_is_joined_where_it_should_be_by_now():
    trajectory = followed(message(rows(1.0, 2.0, 4.0)), now_ms=13)
    assert trajectory.at(13 * MS)[0] == 1.5


def test_a_stamp_of_0_means_now():
    made = message(rows(1.0, 2.0))
    made.header.stamp = Time()
    trajectory = followed(made, now_ms=500)
    assert [trajectory.at(at * MS)[0] for at in (500, 502, 504)] == [0.0, 1.0, 2.0]


def test_joints_are_found_by_their_names():
    trajectory = followed(message([np.arange(12.0)], JOINT_NAMES[::-1]))
    assert trajectory.at(12 * MS).tolist() == np.arange(11.0, -1.0, -1.0).tolist()


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (message(rows(1.0), JOINT_NAMES[1:]), f"joints: {JOINT_NAMES[0]} too many or"),
        (message([[1.0] * 13], [*JOINT_NAMES, "elbow"]), "joints: elbow too many or"),
        (message([[1.0] * 13], [*JOINT_NAMES, JOINT_NAMES[0]]), "some joint twice"),
        (message([[1.0] * 11]), r"points of \[11\] positions for 12 joints"),
        (message([]), r"points of \[\] positions for 12 joints"),
        (message(rows(math.nan)), "a position that is not finite"),
        (message(rows(1.0, 2.0), times_ms=(4, 4)), "do not follow one another"),
    ],
)
def test_what_cannot_be_followed_is_refused(made, said):
    with pytest.raises(RefusedMessageError, match=said):
        followed(made)


def test_what_has_ended_is_refused():
    with pytest.raises(RefusedMessageError, match="has ended already"):
        followed(message(rows(1.0, 2.0)), now_ms=15)
