"""Whatever comes over the graph, robot and memory see sound messages only."""

import itertools
import math
import time

import numpy as np
import pytest
from geometry_msgs.msg import Vector3Stamped
from std_msgs.msg import String
from tests.graph.clients import own_publisher
from tests.graph.domains import MODULE, own_domain
from tests.robots import SHIPPED
from tests.thorough import first_always

from biped_bringup.node_parameters import node_parameters
from biped_bringup.one_executor import OneExecutor
from biped_bringup.run_settings import load_settings
from biped_ros.messages import message_type, segment_template, segment_values
from msgs_json import topics
from trajectory_node.waist_reference import WaistReference

SEED = 5
EPISODES = 8
MESSAGES = 1000
TIMEOUT_S = 60.0


def learned(domain, disturb=None):
    """Learn some episodes on a graph; return memory and trajectory hashes."""
    parameters = node_parameters(
        load_settings("quick"),
        SEED,
        max_episodes=EPISODES,
        publish_every_ticks=10,
        listen_s=0.0,
    )
    with OneExecutor(parameters, domain) as graph:
        session = graph.learner.session
        if disturb is not None:
            assert graph.spin_until(lambda: session.episodes >= 1, TIMEOUT_S)
            disturb(graph)
        assert graph.spin_until(lambda: session.episodes >= EPISODES, TIMEOUT_S)
        return session.memory_sha256(), session.tally.trajectories_sha256


@pytest.fixture(scope="module")
def undisturbed():
    """Return the hashes of a run that nobody interfered with."""
    return learned(own_domain(MODULE))


def strings(kind):
    """Return texts that are no payload of any kind."""
    return {
        "empty": "",
        "no JSON": "{",
        "another thing": '{"version": 1, "legs": 3}',
        "NaN": '{"version": 1, "control_tick": NaN}',
        "another version": '{"version": 99}',
        "garbage": "\u2603" * 40,
    }[kind]


def correction(kind, stamp_s):
    """Return a correction that must not be followed."""
    message = Vector3Stamped()
    message.header.frame_id = "world"
    message.header.stamp.sec = stamp_s
    message.vector.x = {"NaN": math.nan, "infinite": math.inf}.get(kind, 0.0)
    if kind == "out of range":
        message.vector.x = 1.0
    if kind == "between ticks":
        message.header.stamp.nanosec = 1
    return message


def flood(topic, messages):
    """Return a disturbance: its owner publishes these on a control topic, too."""
    return lambda graph: publish_all(
        graph, topic, own_publisher(graph, topic), messages
    )


def publish_all(graph, topic, publisher, messages):
    """Publish until a thousand messages were refused."""
    end = time.monotonic() + TIMEOUT_S
    kinds = itertools.cycle(messages)
    # A short history is overwritten where messages are not taken at once.
    at_once = min(20, topic.depth)
    while (taken := not_acted_on(graph, topic)) < MESSAGES:
        assert time.monotonic() < end
        for _ in range(at_once):
            publisher.publish(next(kinds))
        graph.spin_until(
            lambda taken=taken: not_acted_on(graph, topic) >= taken + at_once, 0.1
        )


def not_acted_on(graph, topic):
    """Return how many messages of a topic were refused or malformed so far."""
    return sum(
        node.counts[f"{topic.name} {kind}"]
        for node in graph.nodes
        for kind in ("refused", "malformed")
    )


@pytest.mark.parametrize(
    "topic",
    first_always([topics.OBSERVATION, topics.EPISODE, topics.PLAN]),
)
def test_malformed_texts_change_nothing(domain, undisturbed, topic):
    kinds = ("empty", "no JSON", "another thing", "NaN", "another version", "garbage")
    messages = [String(data=strings(kind)) for kind in kinds]
    assert learned(domain, flood(topic, messages)) == undisturbed


def test_corrections_that_are_not_for_now_change_nothing(domain, undisturbed):
    kinds = ("NaN", "infinite", "out of range", "between ticks", "stale")
    messages = [correction(kind, stamp_s=0) for kind in kinds]
    assert learned(domain, flood(topics.CORRECTION, messages)) == undisturbed


@pytest.mark.thorough
def test_segments_of_another_form_change_nothing(domain, undisturbed):
    kind = message_type(topics.WAIST_REFERENCE)
    messages = [kind(), kind(joint_names=["waist"])]
    assert learned(domain, flood(topics.WAIST_REFERENCE, messages)) == undisturbed


@pytest.mark.thorough
def test_a_segment_of_the_past_is_never_walked_again(domain, undisturbed):
    settings = load_settings("quick")
    reference = WaistReference(
        SHIPPED, settings.gait, settings.correction, look_ahead_ticks=50
    )
    values = segment_values(reference.segment(np.zeros(2)))
    message = segment_template(reference.rows).fill(values, clock_ticks=1)
    assert learned(domain, flood(topics.WAIST_REFERENCE, [message])) == undisturbed
