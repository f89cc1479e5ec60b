"""Output a list of available services."""

from __future__ import annotations

import argparse

from ros2_verbs.graph.endpoints import SERVICES, with_types
from ros2_verbs.graph.names import print_listed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    SERVICES.add_listing_arguments(parser)
    SERVICES.add_show_types_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the services."""
    print_listed(args, with_types(args, SERVICES.found(args)))
    return 0
