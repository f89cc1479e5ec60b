"""The machine: platform, network interfaces, leftovers in shared memory."""

from __future__ import annotations

import fcntl
import os
import platform
import socket
import struct
from pathlib import Path

from ros2_verbs.doctor.area import Area

_INTERFACES = Path("/sys/class/net")
_SHARED_MEMORY = Path("/dev/shm")

# linux/if.h
_FLAGS = {"UP": 0x1, "BROADCAST": 0x2, "LOOPBACK": 0x8, "MULTICAST": 0x1000}
_SIOCGIFADDR = 0x8915
_IFREQ = struct.Struct("16s24x")
_ADDRESS = slice(20, 24)

_OWNED_BY = "_el"
"""Fast DDS keeps a lock on the file of this ending while it uses the segment."""


def platform_area() -> Area:
    """Report operating system and Python."""
    area = Area("platform", "PLATFORM INFORMATION")
    area.item("system", platform.system())
    area.item("platform info", platform.platform())
    area.item("release", platform.release())
    area.item("processor", platform.machine())
    area.item("python version", platform.python_version())
    if platform.system() != "Linux":
        area.warnings.append(f"{platform.system()} is not tested, only Linux is.")
    return area


def network_area(discovery_range: str, folder: Path = _INTERFACES) -> Area:
    """Check that the interfaces which the discovery range needs are there.

    Args:
        discovery_range: LOCALHOST needs the loopback interface; all others one that
            leaves the machine and carries multicast.
        folder: with a folder for each interface.
    """
    area = Area("network", "NETWORK CONFIGURATION")
    loopback = leaves = multicast = False
    for interface in sorted(folder.iterdir()):
        flags = _flags(interface)
        loopback |= {"UP", "LOOPBACK"} <= flags
        leaves |= "UP" in flags and "LOOPBACK" not in flags
        multicast |= {"UP", "MULTICAST"} <= flags and "LOOPBACK" not in flags
        area.item("device", interface.name)
        if address := _address(interface.name):
            area.item("inet", address)
        area.item("flags", ",".join(name for name in _FLAGS if name in flags))
        area.item("mtu", (interface / "mtu").read_text().strip())
    if not loopback:
        area.errors.append("No loopback IP address is found.")
    if discovery_range != "LOCALHOST":
        if not leaves:
            area.warnings.append("Only loopback IP address is found.")
        if not multicast:
            area.warnings.append("No multicast IP address is found.")
    return area


def shared_memory_area(folder: Path = _SHARED_MEMORY) -> Area:
    """Look for files that killed processes have left behind."""
    area = Area("shared_memory", "SHARED MEMORY")
    segments = sorted(folder.glob("fastrtps_*")) if folder.is_dir() else []
    left = [segment for segment in segments if not _in_use(segment)]
    size = sum(segment.stat().st_size for segment in left if segment.exists())
    area.item("files of Fast DDS", len(segments))
    area.item("without an owner", len(left))
    if left:
        area.warnings.append(
            f"{len(left)} files of Fast DDS in {folder} belong to processes that are "
            f"gone, {size / 1e6:.1f} MB; `fastdds shm clean` removes them."
        )
    return area


def _flags(interface: Path) -> set[str]:
    bits = int((interface / "flags").read_text(), 16)
    return {name for name, bit in _FLAGS.items() if bits & bit}


def _address(interface: str) -> str | None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        request = _IFREQ.pack(interface.encode()[:15])
        try:
            answer = fcntl.ioctl(probe.fileno(), _SIOCGIFADDR, request)
        except OSError:
            return None
    return socket.inet_ntoa(answer[_ADDRESS])


def _in_use(segment: Path) -> bool:
    """Return whether a process holds the segment's lock; unknown counts as held."""
    lock = segment.with_name(segment.name.removesuffix(_OWNED_BY) + _OWNED_BY)
    try:
        descriptor = os.open(lock, os.O_RDONLY)
    except OSError:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(descriptor)
    return False
