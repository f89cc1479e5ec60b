"""Environment variables: what the wheels need, and what chooses whom one meets."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping

from biped_ros.environment import PROFILE, PROFILE_VARIABLE


def prepare_environment() -> None:
    """Set what the wheels need, and the discovery of the project's nodes.

    To be called before rclpy is imported. Whatever the user has set stays. The profile
    makes short verbs quick: with the default a node is found only after 3 s if the
    first announcements are missed. Shared memory is off: a killed verb would leave its
    files behind.
    """
    for name, value in (
        ("AMENT_PREFIX_PATH", sys.prefix),
        ("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4"),
        (PROFILE_VARIABLE, str(PROFILE)),
    ):
        os.environ.setdefault(name, value)


def domain_text(environment: Mapping[str, str] = os.environ) -> str:
    """Return the domain as it was given, perhaps no number."""
    return environment.get("ROS_DOMAIN_ID") or "0"


def discovery_range(environment: Mapping[str, str] = os.environ) -> str:
    """Return who is looked for on the network."""
    return environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SUBNET"
