"""Output an interface prototype."""

from __future__ import annotations

import argparse

from ros2_verbs.messages.text import to_yaml
from ros2_verbs.messages.types import KINDS, all_interfaces, interface_class
from ros2_verbs.options import completed

_FILLED = {"srv": "Request", "action": "Goal"}
"""The part of a service or an action that a caller fills."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    completed(
        parser.add_argument("type", help="type, e.g. geometry_msgs/msg/Twist"),
        lambda **_: [name for kind in KINDS for name in all_interfaces(kind)],
    )
    parser.add_argument(
        "--no-quotes", action="store_true", help="print no quotes around it"
    )


def main(args: argparse.Namespace) -> int:
    """Print what `topic pub` or `service call` takes, with all its defaults.

    Raises:
        VerbError: there is no such interface.
    """
    _, kind, _ = [*args.type.split("/"), "", ""][:3]
    if kind not in KINDS:
        kind = "msg"
    interface = interface_class(args.type, kind)
    if kind in _FILLED:
        interface = getattr(interface, _FILLED[kind])
    prototype = to_yaml(interface())
    print(prototype if args.no_quotes else f'"{prototype}"')
    return 0
