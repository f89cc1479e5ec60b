"""/tf on the graph of a walk: there, and where torso pose and links say."""

import os

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore
from tests.graph.clients import Client, quick
from tests.graph.domains import MODULE, own_domain

from biped_bringup.one_executor import OneExecutor
from biped_description.links import LINK_NAMES
from biped_ros.environment import LOCALHOST, node_environment
from biped_ros.link_transforms import TF
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from biped_view.tf_node import TfNode
from msgs_json.topics import TORSO_POSE

os.environ.update(node_environment(own_domain(MODULE), LOCALHOST))
TIMEOUT_S = 60.0
MESSAGES = 30
INDEPENDENT = get_typestore(Stores.ROS2_JAZZY)


@pytest.fixture(scope="module")
def walked():
    """Return what a subscriber got of /tf and of the torso's pose, during a walk."""
    heard = []
    with (
        OneExecutor(quick(), own_domain(MODULE)) as graph,
        Client(graph, TORSO_POSE) as client,
    ):
        node = TfNode(context=graph.sim.context)
        graph.add(node)
        client.node.create_subscription(
            message_type(TF),
            TF.name,
            lambda message: heard.append(bytes(message)),
            qos_profile(TF),
            raw=True,
        )
        arrived = graph.spin_until(lambda: len(heard) >= MESSAGES, TIMEOUT_S)
        graph.remove(node)
        node.close()
        node.destroy_node()
    assert arrived
    transforms = [
        INDEPENDENT.deserialize_cdr(message, TF.type_name).transforms
        for message in heard
    ]
    return transforms, client.messages[TORSO_POSE.name]


def test_all_links_are_placed(walked):
    transforms, _ = walked
    assert {tuple(t.child_frame_id for t in message) for message in transforms} == {
        LINK_NAMES
    }


def test_the_robot_moves(walked):
    transforms, _ = walked
    for i in (LINK_NAMES.index("torso"), LINK_NAMES.index("left_shank")):
        turns = [
            (m[i].transform.translation.x, m[i].transform.rotation.y)
            for m in transforms
        ]
        assert np.ptp(turns, axis=0).max() > 1e-3, LINK_NAMES[i]


def test_the_torso_is_where_its_pose_says(walked):
    transforms, poses = walked
    published = {
        (pose.header.stamp.sec, pose.header.stamp.nanosec): pose.transform.translation.x
        for pose in poses
    }
    compared = 0
    for torso, *_ in transforms:
        stamp = torso.header.stamp.sec, torso.header.stamp.nanosec
        if stamp in published:
            assert torso.transform.translation.x == published[stamp]
            compared += 1
    assert compared >= MESSAGES // 2
