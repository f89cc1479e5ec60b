"""Output a list of available interface types within one package."""

from __future__ import annotations

import argparse
from typing import Any

from ros2_verbs.interface.kinds import add_kind_arguments, chosen_kinds
from ros2_verbs.messages.types import interfaces_of, packages
from ros2_verbs.options import completed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_kind_arguments(parser)
    completed(
        parser.add_argument("package_name", help="package, e.g. geometry_msgs"),
        _complete_packages,
    )


def main(args: argparse.Namespace) -> int:
    """Print the types."""
    kinds = chosen_kinds(args)
    for name in interfaces_of(args.package_name):
        if name.split("/")[1] in kinds:
            print(name)
    return 0


def _complete_packages(**_: Any) -> list[str]:
    return packages()
