"""Quality of service: the options, and what suits the publishers that are there."""

from __future__ import annotations

import argparse
from copy import copy
from typing import Any

from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)

LISTENING_DEPTH = 1000
"""History of a listener: two seconds at 500 Hz, so that printing may pause."""

_POLICIES: dict[str, Any] = {
    "history": HistoryPolicy,
    "reliability": ReliabilityPolicy,
    "durability": DurabilityPolicy,
    "liveliness": LivelinessPolicy,
}
_PARTS = (*_POLICIES, "depth", "liveliness_lease_duration_seconds")
"""Of a profile, each with an option of its own."""


def add_qos_arguments(
    parser: argparse.ArgumentParser, doing: str, profile: str
) -> None:
    """Add --qos-profile and the options that override parts of it.

    Args:
        parser: of the verb.
        doing: what the profile is for, "publish" or "subscribe".
        profile: the default preset.
    """
    group = parser.add_argument_group("quality of service")
    group.add_argument(
        "--qos-profile",
        choices=QoSPresetProfiles.short_keys(),
        default=profile,
        metavar="PRESET",
        help=f"preset to {doing} with: {', '.join(QoSPresetProfiles.short_keys())} "
        f"(default: {profile})",
    )
    group.add_argument(
        "--qos-depth",
        metavar="N",
        type=int,
        help=f"queue size to {doing} with",
    )
    for name, policy in _POLICIES.items():
        group.add_argument(
            f"--qos-{name}",
            choices=policy.short_keys(),
            metavar="POLICY",
            help=f"{', '.join(policy.short_keys())} (overrides the preset's)",
        )
    group.add_argument(
        "--qos-liveliness-lease-duration-seconds",
        type=float,
        metavar="SECONDS",
        help="how long a silent publisher counts as alive",
    )


def profile_of(args: argparse.Namespace) -> QoSProfile:
    """Return the profile that the options describe."""
    profile = _preset(args.qos_profile)
    for name, policy in _POLICIES.items():
        if chosen := getattr(args, f"qos_{name}"):
            setattr(profile, name, policy.get_from_short_key(chosen))
    if args.qos_liveliness_lease_duration_seconds:
        profile.liveliness_lease_duration = Duration(
            seconds=args.qos_liveliness_lease_duration_seconds
        )
    if args.qos_depth is not None and args.qos_depth >= 0:
        profile.depth = args.qos_depth
    elif profile.durability == DurabilityPolicy.TRANSIENT_LOCAL and not profile.depth:
        profile.depth = 1
    return profile


def listening_profile(node: Node, topic: str, args: argparse.Namespace) -> QoSProfile:
    """Return the options' profile if one was given, else one for all publishers.

    The depth is `LISTENING_DEPTH` unless it was given.
    """
    if any(getattr(args, f"qos_{part}", None) is not None for part in _PARTS):
        profile = profile_of(args)
    else:
        profile = _preset(getattr(args, "qos_profile", "sensor_data"))
        _suit_publishers(profile, node, topic)
    if getattr(args, "qos_depth", None) is None:
        profile.depth = LISTENING_DEPTH
    return profile


def _preset(name: str) -> QoSProfile:
    # A copy, for it is going to be changed.
    return copy(QoSPresetProfiles.get_from_short_key(name))


def _suit_publishers(profile: QoSProfile, node: Node, topic: str) -> None:
    offers = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    if not offers:
        return
    for name, better, common in (
        ("reliability", ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT),
        ("durability", DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE),
    ):
        offered = [getattr(offer, name) == better for offer in offers]
        setattr(profile, name, better if all(offered) else common)
        if any(offered) and not all(offered):
            print(
                f"Some, but not all, publishers are offering {_name(better)}. Falling "
                f"back to {_name(common)} as it will connect to all publishers"
            )


def _name(policy: ReliabilityPolicy | DurabilityPolicy) -> str:
    # The old one, which the original still says.
    return f"QoS{type(policy).__name__}.{policy.name}"
