"""Readings out of messages that come in any order, or incomplete."""

import math
from functools import partial

import pytest
from builtin_interfaces.msg import Time
from geometry_msgs.msg import WrenchStamped
from sensor_msgs.msg import Imu, JointState

from biped_description.joints import JOINT_NAMES
from sim_node.sensor_intake import SensorIntake

ARM = "left_elbow"


def stamped(kind, at, **fields):
    message = kind(**fields)
    message.header.stamp = Time(sec=0, nanosec=at)
    return message


def joints(at, names=JOINT_NAMES):
    numbers = [float(i) for i in range(len(names))]
    return stamped(
        JointState, at, name=list(names), position=numbers, velocity=numbers,
        effort=numbers,
    )  # fmt: skip


def imu(at):
    message = stamped(Imu, at)
    message.linear_acceleration.z = 9.81
    return message


def sole(at, force):
    message = stamped(WrenchStamped, at)
    message.wrench.force.z = force
    message.wrench.torque.x, message.wrench.torque.y = 1.0, 2.0
    return message


def all_but_joints(intake, at):
    intake.imu(imu(at))
    intake.sole(0, sole(at, 100.0))
    intake.sole(1, sole(at, 200.0))


def test_a_reading_is_complete_with_the_last_message_of_an_update():
    intake = SensorIntake()
    all_but_joints(intake, 2)
    assert (intake.complete, intake.newest) == (0, None)
    intake.joint_states(joints(2))
    assert intake.complete == 1
    assert intake.newest.soles.tolist() == [[100.0, 1.0, 2.0], [200.0, 1.0, 2.0]]
    assert intake.newest.acceleration.tolist() == [0.0, 0.0, 9.81]


def test_messages_of_two_updates_make_no_reading():
    intake = SensorIntake()
    all_but_joints(intake, 2)
    intake.joint_states(joints(4))
    assert intake.complete == 0
    all_but_joints(intake, 4)
    assert intake.complete == 1


def test_no_reading_is_lost_where_one_topic_is_ahead_of_another():
    intake = SensorIntake()
    for at in (2, 4, 6):
        intake.joint_states(joints(at))
    stamps = []
    for at in (2, 4, 6):
        all_but_joints(intake, at)
        stamps.append((intake.complete, intake.stamp_ns))
    assert stamps == [(1, 2), (2, 4), (3, 6)]


def test_an_update_before_time_0_makes_no_reading():
    intake = SensorIntake()
    for message, take in (
        (joints(2), intake.joint_states),
        (imu(2), intake.imu),
        (sole(2, 1.0), partial(intake.sole, 0)),
        (sole(2, 1.0), partial(intake.sole, 1)),
    ):
        message.header.stamp.sec = -1
        take(message)
    assert intake.complete == 0


def test_joints_are_found_by_their_names():
    intake = SensorIntake()
    all_but_joints(intake, 2)
    intake.joint_states(joints(2, [ARM, *reversed(JOINT_NAMES)]))
    assert intake.newest.joints[:12].tolist() == [float(12 - i) for i in range(12)]
    assert intake.newest.usable


@pytest.mark.parametrize("missing", JOINT_NAMES)
def test_a_joint_that_is_missing_makes_a_reading_unusable(missing):
    intake = SensorIntake()
    all_but_joints(intake, 2)
    intake.joint_states(joints(2, [name for name in JOINT_NAMES if name != missing]))
    assert not intake.newest.usable
    place = JOINT_NAMES.index(missing)
    assert math.isnan(intake.newest.joints[place])


def test_joints_without_effort_make_a_reading_unusable():
    intake = SensorIntake()
    all_but_joints(intake, 2)
    message = joints(2)
    message.effort = []
    intake.joint_states(message)
    assert not intake.newest.usable
