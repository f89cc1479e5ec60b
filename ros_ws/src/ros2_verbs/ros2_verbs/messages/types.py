"""Interface types by name, from the ament index: package/msg/Type, srv or action."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

from ament_index_python import get_resource, get_resources, has_resource

from ros2_verbs.errors import VerbError

KINDS = {"msg": "message", "srv": "service", "action": "action"}
"""What the interfaces of each kind are called."""
_INDEX = "rosidl_interfaces"
# Every interface has such a file, and the parts of services and actions have none.
_LISTED = ".idl"


def packages() -> list[str]:
    """Return the names of all packages with interfaces."""
    return sorted(get_resources(_INDEX))


def interfaces_of(package: str) -> list[str]:
    """Return the full names of a package's interfaces.

    Raises:
        VerbError: there is no such package.
    """
    if not has_resource(_INDEX, package):
        raise VerbError(f"Unknown package '{package}'")
    content, _ = get_resource(_INDEX, package)
    return sorted(
        f"{package}/{line.removesuffix(_LISTED)}"
        for line in content.splitlines()
        if line.endswith(_LISTED)
    )


def all_interfaces(kind: str) -> list[str]:
    """Return the full names of all interfaces of a kind, one of `KINDS`."""
    return [
        name
        for package in packages()
        for name in interfaces_of(package)
        if name.split("/")[1] == kind
    ]


def complete_message_types(**_: Any) -> list[str]:
    """Return all message types, for the shell."""
    return all_interfaces("msg")


def interface_class(name: str, kind: str) -> Any:
    """Return the class of a type, `std_msgs/msg/String` or `std_msgs/String`.

    Args:
        name: of the type.
        kind: "msg" or "srv", which may be left out in the name.

    Raises:
        VerbError: the name is malformed, or there is no such interface.
    """
    problem = f"The passed {KINDS[kind]} type is invalid: '{name}'"
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] != kind or not all(p.isidentifier() for p in parts):
        raise VerbError(f"{problem} is not of the form package/{kind}/Type")
    package, _, type_name = parts
    try:
        module = importlib.import_module(f"{package}.{kind}")
    except ModuleNotFoundError:
        raise VerbError(f"{problem}, there is no package '{package}'") from None
    try:
        return getattr(module, type_name)
    except AttributeError:
        raise VerbError(f"{problem}, '{package}' has no such {KINDS[kind]}") from None


def definition_file(name: str) -> Path:
    """Return the file in which an interface is defined.

    Raises:
        VerbError: the name is not of the form package/kind/Type, or of nothing here.
    """
    parts = name.split("/")
    if len(parts) != 3 or not all(parts):
        raise VerbError(f"Invalid name '{name}'. Expected three parts separated by '/'")
    package, kind, type_name = parts
    if not has_resource(_INDEX, package):
        raise VerbError(f"Unknown package '{package}'")
    _, prefix = get_resource(_INDEX, package)
    file = Path(prefix) / "share" / package / kind / f"{type_name}.{kind}"
    if kind not in KINDS or not file.is_file():
        raise VerbError(f"Could not find the interface '{name}'")
    return file
