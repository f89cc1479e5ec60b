"""A bag on the graph: its topics as they were published, and services to pause.

What failures do:
    a type's package is not installed: the topic is left out, with a warning.
    subscribers that are on the graph do not get connected in time (another quality of
        service, or gone without saying so): a warning, and playing begins without them.
    a subscriber does not acknowledge: a warning, once per topic, and playing goes on
        without waiting for anybody on that topic.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from rclpy.type_support import check_for_type_support
from std_srvs.srv import Trigger

from biped_bag.player.player import Player
from biped_bag.qos import playing_qos
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_common.terminal_text import printable
from biped_ros.messages import message_type
from msgs_json.topics import Topic

NAME = "player"
# A subscriber with our profile of Fast DDS is found within half a second, any other one
# at its next announcement, 3 s after the last.
_DISCOVERY_S = 3.5
_SETTLED_S = 0.8
_MATCHING_S = 5.0
_ACKNOWLEDGED_S = 2.0
# What was published so long ago has arrived, as long as subscribers live.
_ARRIVED_S = 0.5
_TURN_S = 0.05


@dataclass
class _Output:
    """One topic that is played."""

    publisher: Publisher
    window: int
    """Messages after which acknowledgements are waited for; 0: never."""
    unacknowledged: int = 0


class PlayerNode(Node):  # type: ignore[misc]
    """Publishers for the topics of a bag, with services around a player."""

    def __init__(
        self, topics: Mapping[str, BagTopic], remaps: Mapping[str, str], **options: Any
    ) -> None:
        """Make the publishers; topics of unknown types are left out.

        Args:
            topics: to be played, by their names in the bag.
            remaps: other names under which topics are published.
            options: of `rclpy.node.Node`.
        """
        super().__init__(NAME, **options)
        self._outputs: dict[str, _Output] = {}
        self._acknowledged_at = time.monotonic()
        for name, topic in topics.items():
            self._add(name, topic, remaps.get(name, name))

    @property
    def topics(self) -> frozenset[str]:
        """Names in the bag of what is played."""
        return frozenset(self._outputs)

    def serve(self, player: Player) -> None:
        """Offer services that pause the player, let it go on, and step."""
        for verb, change, done, not_done in (
            ("pause", player.pause, "paused", "not playing"),
            ("resume", player.resume, "playing", "not paused"),
            ("step", player.step, "one message more", "not paused"),
        ):
            answer = partial(_answer, change, done, not_done)
            self.create_service(Trigger, f"{NAME}/{verb}", answer)

    def await_subscribers(self, stopped: Callable[[], bool]) -> None:
        """Wait until the subscribers that are on the graph are connected."""
        began = time.monotonic()
        settled, seen = began, -1
        while not stopped():
            now = time.monotonic()
            there = self._subscribers_on_graph()
            missing = self._unconnected()
            if there != seen:
                settled, seen = now, there
            alone = there == 0 and now - began < _DISCOVERY_S
            if not missing and not alone and now - settled >= _SETTLED_S:
                return
            if now - began > _MATCHING_S:
                self._warn(f"not every subscriber is connected: {', '.join(missing)}")
                return
            time.sleep(_TURN_S)

    def publish(self, message: BagMessage) -> None:
        """Publish a message, and wait where more would overwrite what is on its way."""
        output = self._outputs[message.topic]
        output.publisher.publish(message.data)
        output.unacknowledged += 1
        if 0 < output.window <= output.unacknowledged:
            if time.monotonic() - self._acknowledged_at < _ARRIVED_S:
                self.await_acknowledgements()
            self._count_anew()

    def await_acknowledgements(self) -> None:
        """Wait until everything published has arrived."""
        for name, output in self._outputs.items():
            if output.window and not output.publisher.wait_for_all_acked(
                Duration(seconds=_ACKNOWLEDGED_S)
            ):
                output.window = 0
                self._warn(
                    f"{name}: a subscriber does not acknowledge; it may miss messages"
                )

    def _count_anew(self) -> None:
        for output in self._outputs.values():
            output.unacknowledged = 0
        self._acknowledged_at = time.monotonic()

    def _add(self, name: str, topic: BagTopic, published_as: str) -> None:
        try:
            kind = message_type(Topic(name, topic.type_name))
            check_for_type_support(kind)
        except (ImportError, AttributeError, TypeError, ValueError):
            self._warn(
                f"{name} is left out: no package has its type, {topic.type_name}"
            )
            return
        profile = playing_qos(topic)
        publisher = self.create_publisher(kind, published_as, profile)
        self._outputs[name] = _Output(publisher, _window(profile))

    def _warn(self, text: str) -> None:
        # ROS logs past Python's streams; names of a bag are anybody's.
        self.get_logger().warning(printable(text))

    def _subscribers_on_graph(self) -> int:
        return sum(
            self.count_subscribers(output.publisher.topic_name)
            for output in self._outputs.values()
        )

    def _unconnected(self) -> list[str]:
        return [
            output.publisher.topic_name
            for output in self._outputs.values()
            if output.publisher.get_subscription_count()
            < self.count_subscribers(output.publisher.topic_name)
        ]


def _window(profile: QoSProfile) -> int:
    """Return after how many messages acknowledgements are waited for.

    Half of the history: what is overwritten before it has arrived is lost.
    """
    reliable = profile.reliability == profile.reliability.RELIABLE
    return max(1, profile.depth // 2) if reliable else 0


def _answer(
    change: Callable[[], bool],
    done: str,
    not_done: str,
    _: Trigger.Request,
    response: Trigger.Response,
) -> Trigger.Response:
    response.success = change()
    response.message = done if response.success else not_done
    return response
