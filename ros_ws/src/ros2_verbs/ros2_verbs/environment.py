"""The environment of this process, before rclpy is imported."""

from __future__ import annotations

import os
import sys

from biped_ros.environment import PROFILE, PROFILE_VARIABLE


def prepare_environment() -> None:
    """Set what the wheels need, and the discovery of the project's nodes.

    Whatever the user has set stays. The profile makes short verbs quick: with the
    default a node is found only after 3 s if the first announcements are missed. Shared
    memory is off: a killed verb would leave its files behind.
    """
    for name, value in (
        ("AMENT_PREFIX_PATH", sys.prefix),
        ("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4"),
        (PROFILE_VARIABLE, str(PROFILE)),
    ):
        os.environ.setdefault(name, value)
