"""/tf on the graph: other middleware, which knows the definition only, reads it."""

import os
import time
from dataclasses import dataclass

import numpy as np
import pytest
import rclpy
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import sequence
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic as DdsTopic
from geometry_msgs.msg import TransformStamped
from rclpy.executors import SingleThreadedExecutor
from tests.graph.domains import MODULE, own_domain
from tests.graph.foreign import LOOPBACK, Header, Transform
from tests.robots import SHIPPED

from biped_description.joints import JOINT_NAMES
from biped_description.links import LINK_NAMES
from biped_ros import tf_type
from biped_ros.environment import LOCALHOST, node_environment
from biped_ros.link_transforms import TF, LinkTransforms
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile

DOMAIN = own_domain(MODULE)
os.environ.update(node_environment(DOMAIN, LOCALHOST))
TIMEOUT_S = 30.0
TORSO = np.array([1.0, 2.0, 3.0, 0.0, 0.0, 0.6, 0.8])
MESSAGE = LinkTransforms(SHIPPED.urdf).message(TORSO, np.zeros(len(JOINT_NAMES)), 1234)


@dataclass
class Stamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[Stamped]


@dataclass
class Heard:
    """What came of publishing the message, and what the graph says of the topic."""

    by_cyclone: list
    by_rclpy: list
    endpoint: object


@pytest.fixture(scope="module")
def heard():
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=DOMAIN)
    node = rclpy.create_node("publisher", context=context)
    publisher = node.create_publisher(message_type(TF), TF.name, qos_profile(TF))
    by_rclpy, by_cyclone = [], []
    node.create_subscription(
        message_type(TF), TF.name, by_rclpy.append, qos_profile(TF), raw=True
    )
    domain = Domain(DOMAIN, LOOPBACK)
    participant = DomainParticipant(DOMAIN)
    reader = DataReader(participant, DdsTopic(participant, f"rt{TF.name}", TFMessage))
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    end = time.monotonic() + TIMEOUT_S
    while not (by_rclpy and by_cyclone) and time.monotonic() < end:
        publisher.publish(MESSAGE)
        executor.spin_once(timeout_sec=0.1)
        by_cyclone += reader.take(10)
    (endpoint,) = node.get_publishers_info_by_topic(TF.name)
    del reader, participant, domain
    executor.shutdown()
    rclpy.shutdown(context=context)
    return Heard(by_cyclone, by_rclpy, endpoint)


def test_another_middleware_reads_it_by_the_definition(heard):
    torso, *links = heard.by_cyclone[0].transforms
    assert (torso.header.frame_id, torso.child_frame_id) == ("world", "torso")
    assert (torso.header.stamp.sec, torso.header.stamp.nanosec) == (2, 468_000_000)
    move, turn = torso.transform.translation, torso.transform.rotation
    assert (move.x, move.y, move.z) == (1.0, 2.0, 3.0)
    assert list(turn) == [0.0, 0.0, 0.6, 0.8]
    assert {each.child_frame_id for each in links} == {*LINK_NAMES} - {"torso"}


def test_it_arrives_as_the_bytes_that_were_published(heard):
    assert bytes(heard.by_rclpy[0]) == MESSAGE


def test_the_graph_knows_it_by_its_type_and_hash(heard):
    assert heard.endpoint.topic_type == TF.type_name
    assert str(heard.endpoint.topic_type_hash) == tf_type.TF_TYPE_HASH


def test_there_are_no_objects_of_the_type():
    with pytest.raises(TypeError, match="serialized messages only"):
        message_type(TF)()


def test_another_rosidl_is_refused(monkeypatch):
    """Here: one whose nested type has another name."""
    monkeypatch.setattr(tf_type, "_NESTED", b"geometry_msgs/msg/Pose")
    tf_type.tf_message_class.cache_clear()
    with pytest.raises(ImportError, match="is not that of ROS 2 Jazzy"):
        message_type(TF)
    tf_type.tf_message_class.cache_clear()
    assert TransformStamped()  # the nested type itself is as it was
