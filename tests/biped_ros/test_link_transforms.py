"""/tf: where it puts the links, and what it is made of."""

import hashlib
import json
import sys
from pathlib import Path

import numpy as np
import pinocchio
import pytest
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from tests.robots import SHIPPED

from biped_bag.storage.definitions import message_definition
from biped_description.joints import JOINT_NAMES
from biped_description.links import LINK_NAMES
from biped_ros.cdr import string_message
from biped_ros.link_transforms import (
    TF,
    RobotDescriptionError,
    TransformSource,
)
from biped_ros.markers import torso_pose_template
from biped_ros.messages import joint_state_template
from biped_ros.tf_type import TF_TYPE_HASH
from msgs_json import topics

URDF = SHIPPED.urdf
TICKS = 1234
INDEPENDENT = get_typestore(Stores.ROS2_JAZZY)
GENERATOR = np.random.default_rng(7)
Q = GENERATOR.uniform(-1.0, 1.0, len(JOINT_NAMES))
# Turned about all axes: world to torso.
TORSO = pinocchio.SE3(pinocchio.rpy.rpyToMatrix(0.2, -0.3, 0.7), np.array([1, 2, 3.0]))


def described(urdf=URDF):
    return topics.ROBOT_DESCRIPTION.name, string_message(urdf)


def joint_states(ticks=TICKS, q=Q):
    template = joint_state_template(JOINT_NAMES, with_effort=True)
    return topics.JOINT_STATES.name, template.fill((*q, *-q, *q), ticks)


def torso_pose(ticks=TICKS):
    values = pinocchio.SE3ToXYZQUAT(TORSO)
    return topics.TORSO_POSE.name, torso_pose_template("torso").fill(values, ticks)


def made(*heard):
    """Return the messages of /tf that come of messages, in this order."""
    source = TransformSource()
    answers = [source.hear(topic, message) for topic, message in heard]
    return [answer for answer in answers if answer is not None]


def placements(message):
    """Follow the transforms of a message from the world to every link."""
    transforms = INDEPENDENT.deserialize_cdr(message, TF.type_name).transforms
    found = {"world": pinocchio.SE3.Identity()}
    for each in transforms:
        move, turn = each.transform.translation, each.transform.rotation
        step = pinocchio.XYZQUATToSE3(
            np.array([move.x, move.y, move.z, turn.x, turn.y, turn.z, turn.w])
        )
        found[each.child_frame_id] = found[each.header.frame_id] * step
    return found


def test_the_links_are_where_pinocchio_puts_them():
    model = pinocchio.buildModelFromXML(URDF, pinocchio.JointModelFreeFlyer())
    data = model.createData()
    configuration = pinocchio.neutral(model)
    configuration[:7] = pinocchio.SE3ToXYZQUAT(TORSO)
    for name, position in zip(JOINT_NAMES, Q, strict=True):
        configuration[model.joints[model.getJointId(name)].idx_q] = position
    pinocchio.framesForwardKinematics(model, data, configuration)

    (message,) = made(described(), joint_states(), torso_pose())
    found = placements(message)

    assert found.keys() == {"world", *LINK_NAMES}
    for link in LINK_NAMES:
        expected = data.oMf[model.getFrameId(link)]
        assert found[link].isApprox(expected, 1e-12), link


def test_all_transforms_carry_the_time_of_the_pose():
    (message,) = made(described(), joint_states(), torso_pose())
    transforms = INDEPENDENT.deserialize_cdr(message, TF.type_name).transforms
    stamps = {(t.header.stamp.sec, t.header.stamp.nanosec) for t in transforms}
    assert stamps == {(2, 468_000_000)}


def test_the_order_of_pose_and_joint_states_does_not_matter():
    before = made(described(), joint_states(), torso_pose())
    after = made(described(), torso_pose(), joint_states())
    assert before == after != []


def test_joint_states_of_another_control_tick_are_not_taken():
    assert not made(described(), joint_states(TICKS - 1), torso_pose())
    assert not made(described(), torso_pose(), joint_states(TICKS + 1))


def test_a_pose_is_answered_once():
    assert len(made(described(), torso_pose(), joint_states(), joint_states())) == 1


def test_nothing_is_made_before_the_robot_is_described():
    assert not made(joint_states(), torso_pose())


@pytest.mark.parametrize("cut", [0, 3, 60])
def test_what_is_of_another_form_is_passed_over(cut):
    topic, state = joint_states()
    assert not made(described(), (topic, state[:cut]), torso_pose())
    topic, pose = torso_pose()
    assert not made(described(), joint_states(), (topic, pose[:cut]))


@pytest.mark.parametrize(
    ("urdf", "told"),
    [
        ("walks", "syntax error"),
        ("<robot/>", "has no joint left_hip_yaw"),
        (URDF.replace('axis xyz="0 0 1"', 'axis xyz="up"'), "up is no vector"),
        (URDF.replace('rpy="0 0 0"', 'rpy="0 0 1"'), "is turned against its link"),
        (URDF.replace("axis", "axle"), "has no axis xyz"),
    ],
)
def test_a_robot_whose_links_cannot_be_placed_is_refused_in_a_line(urdf, told):
    with pytest.raises(RobotDescriptionError, match=told) as refused:
        made(described(urdf))
    assert "\n" not in str(refused.value)


def test_the_hash_of_the_type_follows_from_its_public_definition():
    """As rosidl takes it: over the description as JSON, without default values."""
    nested = Path(sys.prefix) / "share/geometry_msgs/msg/TransformStamped.json"
    texts = json.loads(nested.read_text())["type_description_msg"]
    referenced = [texts["type_description"], *texts["referenced_type_descriptions"]]
    for each in referenced:
        for field in each["fields"]:
            del field["default_value"]
    unbounded_sequence_of_nested = 145
    transforms = {
        "type_id": unbounded_sequence_of_nested,
        "capacity": 0,
        "string_capacity": 0,
        "nested_type_name": "geometry_msgs/msg/TransformStamped",
    }
    own = {
        "type_name": TF.type_name,
        "fields": [{"name": "transforms", "type": transforms}],
    }
    description = {
        "type_description": own,
        "referenced_type_descriptions": sorted(
            referenced, key=lambda each: each["type_name"]
        ),
    }
    text = json.dumps(description, separators=(", ", ": "))
    digest = hashlib.sha256(text.encode()).hexdigest()
    assert f"RIHS01_{digest}" == TF_TYPE_HASH


def test_its_definition_is_that_of_an_independent_reader():
    defined = get_types_from_msg(message_definition(TF.type_name), TF.type_name)
    for name, (_, fields) in defined.items():
        assert fields == INDEPENDENT.fielddefs[name][1], name
