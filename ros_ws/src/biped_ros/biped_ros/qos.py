"""Quality of service of the graph's topics, as rclpy wants it."""

from __future__ import annotations

from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from msgs_json.topics import Topic


def qos_profile(topic: Topic) -> QoSProfile:
    """Return the profile with which a topic is published and subscribed to."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=topic.depth,
        reliability=ReliabilityPolicy.RELIABLE,
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL
            if topic.latched
            else DurabilityPolicy.VOLATILE
        ),
    )
