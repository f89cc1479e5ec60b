"""A control topic is heard while its owner alone publishes there."""

import time

import pytest
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.task import Future
from std_msgs.msg import String

from biped_ros.cdr import string_text
from biped_ros.qos import qos_profile
from biped_ros.sole_publisher import Publishers, SolePublisherListener
from msgs_json import topics

TOPIC = topics.OBSERVATION
OWNER = TOPIC.owner
TIMEOUT_S = 20.0


class Listening:
    """A listener, and who speaks to it from contexts of their own."""

    def __init__(self, domain):
        self._domain = domain
        self._speakers = []
        self.heard = []
        self.named = None
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = rclpy.create_node("listener", context=self._context)
        self.listener = SolePublisherListener(
            self._node,
            TOPIC,
            lambda message: self.heard.append(string_text(message)),
            self._on_stranger,
        )
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)

    def _on_stranger(self, topic, text):
        assert topic is TOPIC
        self.named = text

    def speaker(self, name):
        """Return a function that publishes, and one that leaves."""
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=self._domain)
        node = rclpy.create_node(name, context=context)
        publisher = node.create_publisher(String, TOPIC.name, qos_profile(TOPIC))

        def leave():
            node.destroy_node()
            rclpy.shutdown(context=context)
            self._speakers.remove(leave)

        self._speakers.append(leave)
        return lambda text: publisher.publish(String(data=text)), leave

    def until(self, condition, again=lambda: None):
        """Spin until a condition holds, doing something again and again."""
        over = Future()

        def look():
            again()
            if condition() and not over.done():
                over.set_result(None)

        timer = self._node.create_timer(0.02, look)
        self._executor.spin_until_future_complete(over, TIMEOUT_S)
        self._node.destroy_timer(timer)
        assert condition()

    def close(self):
        self._executor.shutdown()
        for leave in list(self._speakers):
            leave()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)


@pytest.fixture
def listening(domain):
    listening = Listening(domain)
    yield listening
    listening.close()


def says(speak, text):
    return lambda: speak(text)


def test_the_owner_is_heard(listening):
    speak, _ = listening.speaker(OWNER)
    listening.until(lambda: listening.heard, says(speak, "owner"))
    assert listening.named is None


def test_one_who_is_not_the_owner_is_named_and_never_heard(listening):
    speak, _ = listening.speaker("rosbag2_player")
    listening.until(lambda: listening.named, says(speak, "stranger"))
    spoken = []
    listening.until(lambda: len(spoken) > 20, lambda: spoken.append(speak("stranger")))
    assert listening.heard == []
    assert "rosbag2_player (this host)" in listening.named


@pytest.mark.parametrize("name", ["rosbag2_player", OWNER])
def test_beside_a_second_publisher_not_even_the_owner_is_heard(listening, name):
    speak, _ = listening.speaker(OWNER)
    listening.until(lambda: listening.heard, says(speak, "owner"))
    other, leave = listening.speaker(name)
    listening.until(lambda: listening.named, says(other, "stranger"))
    heard = len(listening.heard)
    spoken = []
    listening.until(lambda: len(spoken) > 20, lambda: spoken.append(speak("owner")))
    assert len(listening.heard) == heard
    leave()
    listening.until(lambda: len(listening.heard) > heard, says(speak, "owner"))
    assert set(listening.heard) == {"owner"}


def test_nothing_of_those_who_come_and_go_is_ever_heard(listening):
    speak, _ = listening.speaker(OWNER)
    listening.until(lambda: listening.heard, says(speak, "owner"))
    for _ in range(5):
        other, leave = listening.speaker("flood")

        def flood(other=other):
            for _ in range(100):
                other("stranger")

        listening.until(lambda: listening.named, flood)
        leave()
        heard = len(listening.heard)
        listening.until(
            lambda heard=heard: len(listening.heard) > heard, says(speak, "owner")
        )
    assert set(listening.heard) == {"owner"}


def test_who_came_and_went_while_nobody_looked_is_not_heard(listening):
    speak, _ = listening.speaker(OWNER)
    listening.until(lambda: listening.heard, says(speak, "owner"))
    other, leave = listening.speaker("flood")
    time.sleep(1.0)  # to find the subscription, which nobody serves
    for _ in range(50):
        other("stranger")
    time.sleep(0.5)
    leave()
    time.sleep(0.5)
    speak("owner")
    listening.heard.clear()
    listening.until(lambda: listening.heard, says(speak, "owner"))
    assert set(listening.heard) == {"owner"}


def test_who_publishes_is_named_with_the_host(listening):
    listening.speaker(OWNER)
    publishers = Publishers(listening._node)
    listening.until(lambda: publishers.alone(TOPIC))
    assert publishers.any_on(TOPIC) == f"{OWNER} (this host)"
    assert publishers.any_on(topics.EPISODE) is None
