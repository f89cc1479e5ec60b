"""What is installed and how it is set up: ROS, middleware, packages."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, requires, version

from biped_ros.environment import LAST_DOMAIN
from ros2_verbs.doctor.area import Area
from ros2_verbs.environment import discovery_range, domain_text

DISTRIBUTION = "jazzy"
_OURS = "biped"
_RANGES = ("SUBNET", "LOCALHOST", "OFF", "SYSTEM_DEFAULT")
_LAST_SAFE_DOMAIN = 101


def ros_area(environment: Mapping[str, str]) -> Area:
    """Check distribution, domain and discovery range."""
    area = Area("ros", "ROS 2 INFORMATION")
    wheels = DISTRIBUTION if _version(f"ros-{DISTRIBUTION}-rclpy") else None
    sourced = environment.get("ROS_DISTRO")
    area.item("distribution name", sourced or wheels or "unknown")
    area.item("rclpy version", _version("ros-rclpy") or _version("rclpy"))
    if wheels and sourced not in (wheels, None):
        area.errors.append(
            f"ROS_DISTRO is {sourced}, but the wheels are those of {wheels}; start "
            "without a sourced ROS 2."
        )
    elif DISTRIBUTION not in (sourced, wheels):
        area.warnings.append(f"Distribution is not {DISTRIBUTION}, which is tested.")
    _check_domain(area, domain_text(environment))
    chosen = discovery_range(environment)
    area.item("discovery range", chosen)
    if chosen not in _RANGES:
        area.errors.append(
            f"ROS_AUTOMATIC_DISCOVERY_RANGE is {chosen}, must be one of "
            f"{', '.join(_RANGES)}."
        )
    return area


def middleware_area(identifier: str, environment: Mapping[str, str]) -> Area:
    """Report the middleware.

    Args:
        identifier: of the implementation that runs.
        environment: in which it was chosen.
    """
    area = Area("rmw", "RMW MIDDLEWARE")
    area.item("middleware name", identifier)
    for name in (
        "RMW_IMPLEMENTATION",
        "FASTDDS_BUILTIN_TRANSPORTS",
        "FASTRTPS_DEFAULT_PROFILES_FILE",
        "ROS_STATIC_PEERS",
    ):
        if environment.get(name):
            area.item(name, environment[name])
    wanted = environment.get("RMW_IMPLEMENTATION") or identifier
    if wanted != identifier:
        area.errors.append(f"RMW_IMPLEMENTATION is {wanted}, but {identifier} runs.")
    return area


def package_area() -> Area:
    """Check that what the project needs is installed; report the versions."""
    area = Area("package", "PACKAGE VERSIONS")
    try:
        needed = requires(_OURS) or []
    except PackageNotFoundError:
        # Built by colcon: package.xml names what is needed, rosdep installs it.
        return area
    names = {
        re.split(r"[^A-Za-z0-9._-]", text, maxsplit=1)[0]
        for text in needed
        if "extra ==" not in text
    }
    middleware = {"ros-rclpy", "ros-rmw-fastrtps-cpp", "ros-fastrtps"}
    for name in sorted({_OURS, *names, *middleware}):
        found = _version(name)
        area.item(name, found or "missing")
        if found is None and name in names:
            area.errors.append(f"Package {name} is not installed.")
    return area


def _check_domain(area: Area, text: str) -> None:
    area.item("domain id", text)
    if not text.isdecimal() or int(text) > LAST_DOMAIN:
        area.errors.append(
            f"ROS_DOMAIN_ID is {text}, must be a number from 0 to {LAST_DOMAIN}."
        )
    elif int(text) > _LAST_SAFE_DOMAIN:
        area.warnings.append(
            f"Domain {text} uses ports that the system may give to others; up to "
            f"{_LAST_SAFE_DOMAIN} is safe."
        )


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
