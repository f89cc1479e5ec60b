"""Output a list of available services of a given type."""

from __future__ import annotations

import argparse

from ros2_verbs.graph.endpoints import SERVICES
from ros2_verbs.graph.names import print_listed
from ros2_verbs.options import completed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    SERVICES.add_listing_arguments(parser)
    completed(
        parser.add_argument("service_type", help="type, e.g. std_srvs/srv/SetBool"),
        SERVICES.complete_types,
    )


def main(args: argparse.Namespace) -> int:
    """Print the names of the services."""
    services = SERVICES.found(args)
    print_listed(args, [name for name, types in services if args.service_type in types])
    return 0
