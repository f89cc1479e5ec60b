"""The environment in which the nodes run."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from biped_common.errors import BipedError

# A private domain unless one is given: 0 is everybody's default, 101 the last that is
# safe on every system.
FIRST_PRIVATE_DOMAIN, LAST_PRIVATE_DOMAIN = 2, 101
LEASE_S = 5.0
"""For so long a killed node stays on the graph; as in the profiles of Fast DDS."""
LAST_DOMAIN = 232  # beyond it, ports would be beyond 65,535
LOCALHOST = "LOCALHOST"
DISCOVERY_RANGES = (LOCALHOST, "SUBNET")
# As Fast DDS 2, that of Jazzy, names it; the name with FASTDDS came with version 3.
PROFILE_VARIABLE = "FASTRTPS_DEFAULT_PROFILES_FILE"
PROFILE = Path(__file__).parent / "fastdds_profile.xml"
LOOPBACK_PROFILE = Path(__file__).parent / "fastdds_loopback.xml"
_SECURITY_VARIABLE = "ROS_SECURITY_ENABLE"


class NoSecurityError(BipedError):
    """DDS Security was asked for, and this middleware has none."""


def refuse_security() -> None:
    """Refuse DDS Security, which the Fast DDS of the wheels is built without.

    Raises:
        NoSecurityError: the environment asks for it.
    """
    if os.environ.get(_SECURITY_VARIABLE) == "true":  # as rcl reads it
        raise NoSecurityError(
            f"{_SECURITY_VARIABLE}=true: the Fast DDS of the wheels is built without "
            "DDS Security; unset it (docs/security.md says what keeps strangers out)"
        )


def private_domain() -> int:
    """Return a domain that other runs on this machine are unlikely to use."""
    span = LAST_PRIVATE_DOMAIN - FIRST_PRIVATE_DOMAIN + 1
    return FIRST_PRIVATE_DOMAIN + os.getpid() % span


def node_environment(domain: int, discovery_range: str) -> dict[str, str]:
    """Return the variables for the supervisor, its nodes and the player.

    Shared memory is off in both ranges; fastdds_loopback.xml says why, and keeps what
    is LOCALHOST on this machine. To a range of that name the middleware would add it.

    Raises:
        NoSecurityError: DDS Security is asked for.
    """
    refuse_security()
    local = discovery_range == LOCALHOST
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT" if local else discovery_range,
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        "FASTDDS_BUILTIN_TRANSPORTS": "UDPv4",
        PROFILE_VARIABLE: str(LOOPBACK_PROFILE if local else PROFILE),
        "AMENT_PREFIX_PATH": os.environ.get("AMENT_PREFIX_PATH", sys.prefix),
        "PYTHONUNBUFFERED": "1",
        # One thread is enough for arrays of this size, and leaves a core to the others.
        "OMP_NUM_THREADS": "1",
    }
