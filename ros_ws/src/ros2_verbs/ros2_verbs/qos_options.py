"""Quality of service: the options, and what suits the publishers that are there."""

from __future__ import annotations

import argparse

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

_PARTS = (
    "qos_depth",
    "qos_history",
    "qos_reliability",
    "qos_durability",
    "qos_liveliness",
    "qos_liveliness_lease_duration_seconds",
)


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
    for name, policy in (
        ("history", HistoryPolicy),
        ("reliability", ReliabilityPolicy),
        ("durability", DurabilityPolicy),
        ("liveliness", LivelinessPolicy),
    ):
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
    profile = QoSPresetProfiles.get_from_short_key(args.qos_profile)
    if args.qos_history:
        profile.history = HistoryPolicy.get_from_short_key(args.qos_history)
    if args.qos_durability:
        profile.durability = DurabilityPolicy.get_from_short_key(args.qos_durability)
    if args.qos_reliability:
        profile.reliability = ReliabilityPolicy.get_from_short_key(args.qos_reliability)
    if args.qos_liveliness:
        profile.liveliness = LivelinessPolicy.get_from_short_key(args.qos_liveliness)
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
    if any(getattr(args, part, None) is not None for part in _PARTS):
        profile = profile_of(args)
    else:
        preset = getattr(args, "qos_profile", "sensor_data")
        profile = QoSPresetProfiles.get_from_short_key(preset)
        _suit_publishers(profile, node, topic)
    if getattr(args, "qos_depth", None) is None:
        profile.depth = LISTENING_DEPTH
    return profile


def _suit_publishers(profile: QoSProfile, node: Node, topic: str) -> None:
    offers = [info.qos_profile for info in node.get_publishers_info_by_topic(topic)]
    if not offers:
        return
    profile.reliability = (
        ReliabilityPolicy.RELIABLE
        if _all_offer(
            [offer.reliability == ReliabilityPolicy.RELIABLE for offer in offers],
            "QoSReliabilityPolicy.RELIABLE",
            "QoSReliabilityPolicy.BEST_EFFORT",
        )
        else ReliabilityPolicy.BEST_EFFORT
    )
    profile.durability = (
        DurabilityPolicy.TRANSIENT_LOCAL
        if _all_offer(
            [offer.durability == DurabilityPolicy.TRANSIENT_LOCAL for offer in offers],
            "QoSDurabilityPolicy.TRANSIENT_LOCAL",
            "QoSDurabilityPolicy.VOLATILE",
        )
        else DurabilityPolicy.VOLATILE
    )


def _all_offer(offered: list[bool], better: str, common: str) -> bool:
    if any(offered) and not all(offered):
        print(
            f"Some, but not all, publishers are offering {better}. Falling back to "
            f"{common} as it will connect to all publishers"
        )
    return all(offered)
