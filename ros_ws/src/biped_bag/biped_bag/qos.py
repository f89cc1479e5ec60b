"""Quality of service: as publishers offer it, as bags write it, as it is asked for.

Bags write it with rosbag2's keys and words; see `storage.contents`.
"""

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

from biped_bag.storage.contents import BagTopic, OfferedQos
from biped_common.timing import NS_PER_S

RECORDED_DEPTH = 5000
"""Received, but not taken yet. At ten times 500 Hz this is one second."""
# The graph does not tell how much history a publisher keeps. Much of it here, for
# the player waits for acknowledgements whenever half of it is on its way.
_PLAYED_DEPTH = 5000
_LATCHED_DEPTH = 1
# rosbag2 has written both words and rmw's numbers.
_RELIABLE = ("reliable", "1", 1)


def recording_qos(offered: Sequence[QoSProfile]) -> QoSProfile:
    """Return the strictest profile that receives from all of these publishers."""
    return _profile(
        RECORDED_DEPTH,
        reliable=all(q.reliability == ReliabilityPolicy.RELIABLE for q in offered),
        latched=bool(offered) and all(is_latched(q) for q in offered),
    )


def playing_qos(topic: BagTopic) -> QoSProfile:
    """Return a profile with which whoever heard the recorded publishers hears again.

    Reliable and transient local as soon as one of them was; kept is as much as the
    most thorough of them kept, where that is known, and 5,000 messages at most.
    """
    offered = topic.offered_qos
    depth = max(map(_depth, offered), default=0)
    return _profile(
        depth or (_LATCHED_DEPTH if topic.latched else _PLAYED_DEPTH),
        reliable=not offered or any(q.get("reliability") in _RELIABLE for q in offered),
        latched=topic.latched,
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


def _depth(offered: OfferedQos) -> int:
    depth = offered.get("depth")
    if not isinstance(depth, int) or depth < 0:
        return 0  # not known
    return min(depth, _PLAYED_DEPTH)


def _profile(depth: int, *, reliable: bool, latched: bool) -> QoSProfile:
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=(
            ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT
        ),
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
        ),
    )


def _time(duration: Duration) -> dict[str, int]:
    seconds, nanoseconds = divmod(duration.nanoseconds, NS_PER_S)
    return {"sec": seconds, "nsec": nanoseconds}
