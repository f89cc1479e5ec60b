"""Output a list of packages that provide interfaces."""

from __future__ import annotations

import argparse

from ros2_verbs.interface.kinds import add_kind_arguments, chosen_kinds
from ros2_verbs.messages.types import interfaces_of, packages


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_kind_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print the packages that have interfaces of the kinds asked for."""
    kinds = chosen_kinds(args)
    for package in packages():
        if any(name.split("/")[1] in kinds for name in interfaces_of(package)):
            print(package)
    return 0
