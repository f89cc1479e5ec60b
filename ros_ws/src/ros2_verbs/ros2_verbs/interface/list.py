"""List all interface types available."""

from __future__ import annotations

import argparse

from ros2_verbs.interface.kinds import add_kind_arguments, chosen_kinds
from ros2_verbs.messages.types import KINDS, all_interfaces


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_kind_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print the types, kind by kind."""
    for kind in chosen_kinds(args):
        print(f"{KINDS[kind].capitalize()}s:")
        for name in all_interfaces(kind):
            print(f"    {name}")
    return 0
