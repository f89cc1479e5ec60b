"""Quality of service as publishers offer it: to subscribe with, and to write down."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

# Received, but not taken yet. At ten times 500 Hz this is one second.
DEPTH = 5000


def matching_qos(offered: Sequence[QoSProfile]) -> QoSProfile:
    """Return the strictest profile that receives from all of these publishers."""
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=DEPTH,
        reliability=(
            ReliabilityPolicy.RELIABLE
            if all(q.reliability == ReliabilityPolicy.RELIABLE for q in offered)
            else ReliabilityPolicy.BEST_EFFORT
        ),
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL
            if offered and all(is_latched(q) for q in offered)
            else DurabilityPolicy.VOLATILE
        ),
    )


def is_latched(qos: QoSProfile) -> bool:
    """Return whether who comes later still gets the last messages."""
    return bool(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL)


def receives_from(asked: QoSProfile, offered: QoSProfile) -> bool:
    """Return whether a subscription gets what a publisher sends."""
    reliable = ReliabilityPolicy.RELIABLE
    return (asked.reliability != reliable or offered.reliability == reliable) and (
        not is_latched(asked) or is_latched(offered)
    )


def as_rosbag2(qos: QoSProfile) -> dict[str, Any]:
    """Return a profile with the keys and words of rosbag2."""
    return {
        "history": qos.history.name.lower(),
        "depth": qos.depth,
        "reliability": qos.reliability.name.lower(),
        "durability": qos.durability.name.lower(),
        "deadline": _time(qos.deadline),
        "lifespan": _time(qos.lifespan),
        "liveliness": qos.liveliness.name.lower(),
        "liveliness_lease_duration": _time(qos.liveliness_lease_duration),
        "avoid_ros_namespace_conventions": qos.avoid_ros_namespace_conventions,
    }


def _time(duration: Duration) -> dict[str, int]:
    seconds, nanoseconds = divmod(duration.nanoseconds, 1_000_000_000)
    return {"sec": seconds, "nsec": nanoseconds}
