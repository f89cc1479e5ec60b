"""Definitions: complete, and understood by parsers that are not ours."""

import sys
from pathlib import Path

import pytest
from mcap_ros2._dynamic import generate_dynamic
from rosbags.typesys import get_types_from_msg

from biped_bag.errors import BagError
from biped_bag.storage.definitions import message_definition

PACKAGES = (
    "builtin_interfaces",
    "diagnostic_msgs",
    "geometry_msgs",
    "nav_msgs",
    "rcl_interfaces",
    "rosgraph_msgs",
    "sensor_msgs",
    "std_msgs",
    "trajectory_msgs",
    "visualization_msgs",
)


def installed_messages():
    """Return the messages of the packages, package/msg/Type."""
    share = Path(sys.prefix) / "share"
    return sorted(
        f"{package}/msg/{file.stem}"
        for package in PACKAGES
        for file in (share / package / "msg").glob("*.msg")
    )


def test_every_installed_message_is_understood_by_mcap_ros2():
    for name in installed_messages():
        types = generate_dynamic(name, message_definition(name))
        assert name in types


def test_every_installed_message_is_complete_for_rosbags():
    for name in installed_messages():
        root, *nested = message_definition(name).split(f"{'=' * 80}\nMSG: ")
        texts = {name: root} | dict(part.split("\n", 1) for part in nested)
        known = {
            kind.replace("/msg", "") for kind in get_types_from_msg(root, name)
        } | {part.split("\n", 1)[0] for part in nested}
        for kind, text in texts.items():
            full = kind if "/msg/" in kind else kind.replace("/", "/msg/")
            for fields in get_types_from_msg(text, full).values():
                assert referred(fields) <= known, name


def referred(fields):
    """Return the nested types that rosbags' parser found, package/Type."""
    names = set()
    for _, (kind, about) in fields[1]:
        while kind in (3, 4):  # arrays and sequences hold another type
            kind, about = about[0]
        if kind == 2:
            names.add(about.replace("/msg", ""))
    return names


def test_a_type_that_is_not_installed_is_named():
    with pytest.raises(BagError, match=r"^nobody_msgs/msg/Nothing: no installed"):
        message_definition("nobody_msgs/msg/Nothing")


def test_a_name_of_another_form_is_refused():
    with pytest.raises(BagError, match="must have the form package/msg/Type"):
        message_definition("std_msgs/String")
