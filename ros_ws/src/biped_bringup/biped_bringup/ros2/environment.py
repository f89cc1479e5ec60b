"""The environment of this process, before rclpy is imported."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_PROFILE = Path(__file__).parent / "quick_discovery.xml"


def prepare_environment() -> None:
    """Set what the wheels need and what makes short verbs quick.

    Whatever the user has set stays. A profile announces the node every 50 ms, since
    with the default it is found only after 3 s if the first announcements are missed.
    Shared memory is off: a killed verb would leave its files behind.
    """
    for name, value in (
        ("AMENT_PREFIX_PATH", sys.prefix),
        ("FASTDDS_BUILTIN_TRANSPORTS", "UDPv4"),
        ("FASTRTPS_DEFAULT_PROFILES_FILE", str(_PROFILE)),
    ):
        os.environ.setdefault(name, value)


def lasting_environment() -> dict[str, str]:
    """Return the environment for a node that stays: without the verbs' profile."""
    environment = dict(os.environ)
    if environment.get("FASTRTPS_DEFAULT_PROFILES_FILE") == str(_PROFILE):
        del environment["FASTRTPS_DEFAULT_PROFILES_FILE"]
    return environment
