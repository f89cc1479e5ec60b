"""Subscriptions to everything that is wanted, and what has come over them.

Messages are taken out of the middleware's queues in turns, with the times and numbers
that it keeps with them: this costs 2 us a message where a callback costs 20. The node
that holds the subscriptions must therefore not be given to an executor.

In simulated time a message's log time is that of the last message on /clock that had
been received before it; what came before the first one is left out.
"""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.subscription import Subscription

from biped_bag.qos import RECORDED_DEPTH, as_rosbag2, receives_from, recording_qos
from biped_bag.recorder.continuity import Continuity
from biped_bag.recorder.sim_time import SimTime
from biped_bag.selection import Selection
from biped_bag.storage.contents import BagMessage, BagTopic, OfferedQos
from biped_ros.qos import qos_profile
from msgs_json.topics import Topic


@dataclass
class IncomingTopic:
    """One topic that is listened to."""

    name: str
    type_name: str
    message_class: Any
    qos: QoSProfile
    """Asked for."""
    subscription: Subscription
    received: int = 0
    continuity: Continuity = field(default_factory=Continuity)
    announced: bool = False
    publishers_there: int = 0
    gids: set[bytes] = field(default_factory=set)


def listener_beside(node: Node) -> Node:
    """Return a node for the subscriptions of another one's intake; nobody spins it."""
    return rclpy.create_node(
        f"_{node.get_name()}_intake",
        context=node.context,
        enable_rosout=False,
        start_parameter_services=False,
    )


class Intake:
    """Everything that the recorder hears."""

    def __init__(
        self,
        listener: Node,
        selection: Selection,
        announce: Callable[[BagTopic], None],
        warn: Callable[[str], None],
        *,
        sim_time: bool = False,
    ) -> None:
        """Listen to nothing yet.

        Args:
            listener: node for the subscriptions, in no executor.
            selection: of topics.
            announce: told of a topic once, before its first message is taken.
            warn: told, once, of every topic that cannot be recorded in full.
            sim_time: whether log times are simulated time.
        """
        self.paused = False
        """What comes meanwhile is taken, and left out."""
        self.topics: dict[str, IncomingTopic] = {}
        self._listener = listener
        self._selection = selection
        self._announce = announce
        self._warn = warn
        self._given_up: set[str] = set()
        self._held: list[BagMessage] = []
        self._sim_time = SimTime(listener) if sim_time else None

    def leave_out(self, name: str) -> None:
        """Never listen to a topic, whoever publishes it."""
        self._given_up.add(name)

    def expect(self, topics: Iterable[Topic]) -> None:
        """Listen to topics that will be published as their contract says."""
        for topic in topics:
            if self._selection.wants(topic.name, [topic.type_name]):
                qos = recording_qos([qos_profile(topic)])
                self._listen(topic.name, topic.type_name, qos)

    def look_around(self) -> None:
        """Listen to what has come up on the graph."""
        for name, type_names in self._listener.get_topic_names_and_types():
            wanted = self._selection.wants(name, type_names)
            if name in self._given_up or not wanted:
                continue
            there = self._listener.count_publishers(name)
            topic = self.topics.get(name)
            if there == (0 if topic is None else topic.publishers_there):
                continue
            if len(type_names) > 1:
                self._give_up(name, f"has several types, {', '.join(type_names)}")
            else:
                self._meet(name, type_names[0])

    def take(self) -> list[BagMessage]:
        """Return what has come, in the order in which it was received."""
        horizon_ns = time.time_ns()
        batch, self._held = self._held, []
        for topic in self.topics.values():
            self._take_all(topic, horizon_ns, batch)
        batch.sort(key=lambda message: message.log_ns)
        if self._sim_time is not None:
            batch = list(self._sim_time.stamped(batch))
        return batch

    def _take_all(
        self, topic: IncomingTopic, horizon_ns: int, batch: list[BagMessage]
    ) -> None:
        queue = topic.subscription.handle
        with queue:  # keeps it from being destroyed
            for _ in range(RECORDED_DEPTH):
                taken = queue.take_message(topic.message_class, True)
                if taken is None:
                    return
                topic.received += 1
                data, about = taken
                number = about["publication_sequence_number"]
                topic.continuity.take(number)
                if self.paused:
                    continue
                if not topic.announced:
                    self._meet(topic.name, topic.type_name)
                if not topic.announced:
                    self._make_known(topic, [as_rosbag2(topic.qos)])
                message = BagMessage(
                    topic.name,
                    data,
                    about["received_timestamp"],
                    about["source_timestamp"],
                    number,
                )
                # What came while the queues are being emptied waits a turn, so that
                # nothing of another topic that came before it is written after it.
                late = message.log_ns > horizon_ns
                (self._held if late else batch).append(message)

    def _meet(self, name: str, type_name: str) -> None:
        """Take in the publishers of a topic; subscribe if that is still to be done."""
        infos = self._listener.get_publishers_info_by_topic(name)
        offered = [info.qos_profile for info in infos]
        topic = self.topics.get(name)
        if (
            topic is not None
            and not topic.received
            and not all(receives_from(topic.qos, each) for each in offered)
        ):
            # It was expected with another quality of service.
            self._listener.destroy_subscription(topic.subscription)
            topic = None
        if topic is None:
            topic = self._listen(name, type_name, recording_qos(offered))
        if topic is None:
            return
        topic.publishers_there = len(infos)
        topic.gids |= {bytes(info.endpoint_gid) for info in infos}
        topic.continuity.publishers = max(1, len(topic.gids))
        if any(not receives_from(topic.qos, each) for each in offered):
            self._warn(f"{name}: a publisher offers less than is asked for, unrecorded")
        if infos and not topic.announced:
            offered_qos = [as_rosbag2(each) for each in offered]
            self._make_known(topic, offered_qos, str(infos[0].topic_type_hash))

    def _make_known(
        self,
        topic: IncomingTopic,
        offered_qos: Sequence[OfferedQos],
        type_hash: str = "",
    ) -> None:
        topic.announced = True
        self._announce(BagTopic(topic.name, topic.type_name, offered_qos, type_hash))

    def _listen(
        self, name: str, type_name: str, qos: QoSProfile
    ) -> IncomingTopic | None:
        try:
            package, kind, message = type_name.split("/")
            cls = getattr(importlib.import_module(f"{package}.{kind}"), message)
            subscription = self._listener.create_subscription(
                cls, name, lambda _: None, qos, raw=True
            )
        except (ImportError, AttributeError, ValueError) as error:
            self._give_up(name, f"its type {type_name} is not installed ({error})")
            return None
        self.topics[name] = IncomingTopic(name, type_name, cls, qos, subscription)
        return self.topics[name]

    def _give_up(self, name: str, reason: str) -> None:
        self._given_up.add(name)
        self._warn(f"{name} is left out: {reason}")
