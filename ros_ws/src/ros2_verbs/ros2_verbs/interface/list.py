"""List all interface types available."""

from __future__ import annotations

import argparse

from ros2_verbs import message_types
from ros2_verbs.interface_kinds import add_kind_arguments, chosen_kinds

_TITLES = {"msg": "Messages:", "srv": "Services:", "action": "Actions:"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_kind_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print the types, kind by kind."""
    for kind in chosen_kinds(args):
        print(_TITLES[kind])
        for name in message_types.all_interfaces(kind):
            print(f"    {name}")
    return 0
