"""Output a list of available services of a given type."""

from __future__ import annotations

import argparse

from ros2_verbs.completion import completed
from ros2_verbs.listing import add_listing_arguments, listed, print_listed
from ros2_verbs.service_names import (
    add_hidden_argument,
    complete_service_types,
    service_names_and_types,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_listing_arguments(parser, "services")
    completed(
        parser.add_argument(
            "service_type", help="type to look for (e.g. 'std_srvs/srv/SetBool')"
        ),
        complete_service_types,
    )
    add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the services of a type."""
    hidden = args.include_hidden_services
    services = listed(args, lambda node: service_names_and_types(node, hidden=hidden))
    print_listed(args, [name for name, types in services if args.service_type in types])
    return 0
