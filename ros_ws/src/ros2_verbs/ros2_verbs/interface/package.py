"""Output a list of available interface types within one package."""

from __future__ import annotations

import argparse

from ros2_verbs import completion, message_types
from ros2_verbs.interface_kinds import add_kind_arguments, chosen_kinds


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_kind_arguments(parser)
    completion.completed(
        parser.add_argument("package_name", help="package, e.g. geometry_msgs"),
        completion.package_names,
    )


def main(args: argparse.Namespace) -> int:
    """Print the types."""
    kinds = chosen_kinds(args)
    for name in message_types.interfaces_of(args.package_name):
        if name.split("/")[1] in kinds:
            print(name)
    return 0
