"""The quality of service with which a recorded topic is played."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
)

from biped_bag.errors import BagError
from biped_bag.reader import BagTopic

# The graph does not tell how much history a publisher keeps. Much of it here, for
# the player waits for acknowledgements whenever half of it is on its way.
_DEPTH = 5000
_LATCHED_DEPTH = 1
# rosbag2 has written both words and rmw's numbers.
_RELIABLE = ("reliable", "1", 1)


def playback_qos(topic: BagTopic) -> QoSProfile:
    """Return a profile with which whoever heard the recorded publishers hears again.

    Reliable and transient local as soon as one of them was; kept is as much as the
    most thorough of them kept, where that is known.

    Raises:
        BagError: the recorded profiles cannot be understood.
    """
    profiles = _profiles(topic)
    depths = [int(p.get("depth") or 0) for p in profiles]
    least = _LATCHED_DEPTH if topic.latched else _DEPTH
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=max(depths, default=0) or least,
        reliability=(
            ReliabilityPolicy.RELIABLE
            if not profiles or any(p.get("reliability") in _RELIABLE for p in profiles)
            else ReliabilityPolicy.BEST_EFFORT
        ),
        durability=(
            DurabilityPolicy.TRANSIENT_LOCAL
            if topic.latched
            else DurabilityPolicy.VOLATILE
        ),
    )


def _profiles(topic: BagTopic) -> list[Mapping[str, Any]]:
    try:
        profiles = yaml.safe_load(topic.qos) if topic.qos else []
    except yaml.YAMLError:
        profiles = None
    if not isinstance(profiles, list) or not all(
        isinstance(profile, Mapping) for profile in profiles
    ):
        raise BagError(f"topic {topic.name}: its QoS profiles cannot be understood")
    return profiles
