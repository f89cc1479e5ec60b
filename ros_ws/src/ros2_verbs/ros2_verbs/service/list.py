"""Output a list of available services."""

from __future__ import annotations

import argparse

from ros2_verbs.listing import add_listing_arguments, listed, print_listed
from ros2_verbs.service_names import (
    add_hidden_argument,
    service_names_and_types,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_listing_arguments(parser, "services")
    parser.add_argument(
        "-t",
        "--show-types",
        action="store_true",
        help="additionally show the service type",
    )
    add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the services."""
    hidden = args.include_hidden_services
    services = listed(args, lambda node: service_names_and_types(node, hidden=hidden))
    lines = [
        f"{name} [{', '.join(types)}]" if args.show_types else name
        for name, types in services
    ]
    print_listed(args, lines)
    return 0
