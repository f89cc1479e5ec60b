"""The bridge on a real graph, seen by a real client of Foxglove's protocol."""

import os
import socket
import sys
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import pytest
import rclpy
from rclpy.parameter import Parameter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from tests.biped_view.foxglove.client import FoxgloveClient
from tests.graph.clients import quick
from tests.graph.domains import MODULE, own_domain
from tests.robots import SHIPPED

from biped_bringup.one_executor import OneExecutor
from biped_common.errors import BipedError
from biped_ros.cdr import string_text
from biped_ros.environment import LOCALHOST, node_environment
from biped_ros.link_transforms import TF
from biped_view.foxglove.bridge import FoxgloveBridge
from msgs_json import topics

os.environ.update(node_environment(own_domain(MODULE), LOCALHOST))
TIMEOUT_S = 60.0
INDEPENDENT = get_typestore(Stores.ROS2_JAZZY)
LATCHED = [topics.ROBOT_DESCRIPTION.name, topics.PLAN.name]
WANTED = [TF.name, topics.TORSO_POSE.name, topics.JOINT_STATES.name, *LATCHED]


@dataclass
class Seen:
    """What a client saw, and one that came later."""

    first: FoxgloveClient
    late: FoxgloveClient


@pytest.fixture(scope="module")
def seen():
    """Let the robot walk for a while, with two clients at the bridge."""
    with OneExecutor(quick(), own_domain(MODULE)) as graph:
        bridge = FoxgloveBridge(
            context=graph.sim.context,
            parameter_overrides=[Parameter("port", value=0)],
        )
        graph.add(bridge)
        clients = []

        def client(messages):
            each = FoxgloveClient(bridge.server.url, WANTED)
            clients.append(each)
            assert graph.spin_until(
                lambda: (
                    len(each.received[TF.name]) >= messages
                    and all(each.received[name] for name in LATCHED)
                ),
                TIMEOUT_S,
            )
            return each

        try:
            yield Seen(client(40), client(1))
        finally:
            for each in clients:
                each.close()
            graph.remove(bridge)
            bridge.close()
            bridge.destroy_node()


@contextmanager
def bridge_alone(port):
    """A bridge that nobody spins."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=own_domain(MODULE))
    try:
        yield FoxgloveBridge(
            context=context, parameter_overrides=[Parameter("port", value=port)]
        )
    finally:
        rclpy.shutdown(context=context)


def transforms(client):
    return [
        INDEPENDENT.deserialize_cdr(message, TF.type_name).transforms
        for message in list(client.received[TF.name])
    ]


def test_every_topic_is_advertised_with_its_ros_definition(seen):
    channels = seen.first.channels
    ours = {t for t in vars(topics).values() if isinstance(t, topics.Topic)}
    assert {(t.name, t.type_name) for t in {TF, *ours}} <= {
        (name, channel["schemaName"]) for name, channel in channels.items()
    }
    for channel in channels.values():
        assert (channel["encoding"], channel["schemaEncoding"]) == ("cdr", "ros2msg")
        own = channel["schemaName"]
        fields = get_types_from_msg(channel["schema"], own)[own][1]
        assert fields == INDEPENDENT.fielddefs[own][1], own


def test_nothing_can_be_asked_of_the_server(seen):
    assert seen.first.server["capabilities"] == []


def test_messages_come_as_the_bytes_that_were_published(seen):
    pose, *_ = seen.first.received[topics.TORSO_POSE.name]
    assert INDEPENDENT.deserialize_cdr(pose, topics.TORSO_POSE.type_name)
    description, *_ = seen.first.received[topics.ROBOT_DESCRIPTION.name]
    assert string_text(description) == SHIPPED.urdf


def test_the_robot_moves_by_tf(seen):
    walked = transforms(seen.first)
    assert all(len(message) == 13 for message in walked)
    ahead = [message[0].transform.translation.x for message in walked]
    knees = [
        each.transform.rotation.y
        for message in walked
        for each in message
        if each.child_frame_id == "left_shank"
    ]
    assert np.ptp(ahead) > 1e-3
    assert np.ptp(knees) > 1e-3


def test_tf_puts_the_torso_where_its_pose_says(seen):
    poses = {}
    for message in list(seen.first.received[topics.TORSO_POSE.name]):
        pose = INDEPENDENT.deserialize_cdr(message, topics.TORSO_POSE.type_name)
        poses[pose.header.stamp.sec, pose.header.stamp.nanosec] = pose.transform
    for torso, *_ in transforms(seen.first)[1:]:
        stamp = torso.header.stamp
        assert poses[stamp.sec, stamp.nanosec] == torso.transform


def test_who_comes_later_still_gets_what_is_latched(seen):
    for name in LATCHED:
        assert seen.late.received[name][0] == seen.first.received[name][0]


def test_a_port_that_is_taken_is_named_in_a_line():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with (
            pytest.raises(BipedError, match=f"port {port} of 127.0.0.1: ") as refused,
            bridge_alone(port),
        ):
            pass
    assert "\n" not in str(refused.value)


def test_without_the_library_it_is_said_what_to_install(monkeypatch, biped, tmp_path):
    monkeypatch.delitem(sys.modules, "biped_view.foxglove.server", raising=False)
    monkeypatch.setitem(sys.modules, "foxglove", None)
    with (
        pytest.raises(BipedError, match=r"pip install 'biped\[foxglove\]'"),
        bridge_alone(0),
    ):
        pass
    outcome = biped("up", "--foxglove", "--out", tmp_path)
    assert outcome.status == 2
    assert outcome.err.count("\n") == 1
    assert "--foxglove: needs pip install 'biped[foxglove]'" in outcome.err
