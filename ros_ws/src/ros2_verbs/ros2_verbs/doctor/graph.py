"""The graph: names taken twice, topics with one end, ends that cannot meet."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from rclpy.node import Node
from rclpy.qos import QoSCompatibility, qos_check_compatible
from rclpy.topic_endpoint_info import TopicEndpointInfo

from ros2_verbs.doctor.area import Area
from ros2_verbs.graph.endpoints import TOPICS
from ros2_verbs.graph.names import node_names

_EVERY_NODE_HAS = ("/parameter_events", "/rosout")


@dataclass(frozen=True)
class Topic:
    """A topic and its ends."""

    name: str
    types: Sequence[str]
    publishers: Sequence[TopicEndpointInfo]
    subscriptions: Sequence[TopicEndpointInfo]


def topics_of(node: Node) -> list[Topic]:
    """Return the topics on the graph but those of every node."""
    return [
        Topic(
            name,
            types,
            node.get_publishers_info_by_topic(name),
            node.get_subscriptions_info_by_topic(name),
        )
        for name, types in TOPICS.known(node, hidden=False)
        if name not in _EVERY_NODE_HAS
    ]


def nodes_of(node: Node) -> list[str]:
    """Return the names of the nodes on the graph, one for each."""
    return [name.full for name in node_names(node, hidden=False)]


def node_area(names: Sequence[str]) -> Area:
    """Look for names that occur twice: two learners would both correct the waist."""
    area = Area("node", "NODE LIST")
    for name, count in sorted(Counter(names).items()):
        area.item("node", name)
        if count > 1:
            area.errors.append(
                f"{count} nodes share the name {name}; one that was killed stays on "
                "the graph until its lease ends, 20 s unless set."
            )
    if not names:
        area.item("node", "none")
    return area


def topic_area(topics: Sequence[Topic]) -> Area:
    """Look for topics with publishers only, subscriptions only, or two types."""
    area = Area("topic", "TOPIC LIST")
    if not topics:
        area.item("topic", "none")
    for topic in topics:
        area.item("topic", topic.name)
        area.item("publisher count", len(topic.publishers))
        area.item("subscriber count", len(topic.subscriptions))
        if not topic.subscriptions:
            area.warnings.append(
                f"Publisher without subscriber detected on {topic.name}."
            )
        elif not topic.publishers:
            area.warnings.append(
                f"Subscriber without publisher detected on {topic.name}."
            )
        if len(topic.types) > 1:
            area.errors.append(
                f"{topic.name} has more than one type: {', '.join(topic.types)}."
            )
    return area


def qos_area(topics: Sequence[Topic]) -> Area:
    """Check every publisher against every subscription of its topic."""
    area = Area("middleware", "QOS COMPATIBILITY LIST")
    for topic in topics:
        for publisher in topic.publishers:
            for subscription in topic.subscriptions:
                _check_pair(area, topic, publisher, subscription)
    if not area.items:
        area.item("compatibility status", "No publisher/subscriber pairs found")
    return area


def _check_pair(
    area: Area,
    topic: Topic,
    publisher: TopicEndpointInfo,
    subscription: TopicEndpointInfo,
) -> None:
    verdict, reason = qos_check_compatible(
        publisher.qos_profile, subscription.qos_profile
    )
    area.item("topic [type]", f"{topic.name} [{', '.join(topic.types)}]")
    area.item("publisher node", publisher.node_name)
    area.item("subscriber node", subscription.node_name)
    good = verdict == QoSCompatibility.OK
    area.item("compatibility status", "OK" if good else reason)
    detail = reason.partition(": ")[2]
    if verdict == QoSCompatibility.ERROR:
        area.errors.append(
            f"QoS compatibility error found on topic '{topic.name}': {detail}"
        )
    elif verdict == QoSCompatibility.WARNING:
        area.warnings.append(
            f"QoS compatibility warning found on topic '{topic.name}': {detail}"
        )
