"""Output a list of available services of a given type."""

from __future__ import annotations

import argparse

from biped_bringup.ros2.completion import completed
from biped_bringup.ros2.graph_node import (
    add_graph_arguments,
    discover,
    graph_node,
    settled,
)
from biped_bringup.ros2.service_names import (
    add_hidden_argument,
    complete_service_types,
    service_names_and_types,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    completed(
        parser.add_argument(
            "service_type", help="type to look for (e.g. 'std_srvs/srv/SetBool')"
        ),
        complete_service_types,
    )
    parser.add_argument(
        "-c",
        "--count-services",
        action="store_true",
        help="only display the number of services discovered",
    )
    add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the services of a type."""
    with graph_node(args) as node:
        discover(args, until=settled(node))
        services = service_names_and_types(node, hidden=args.include_hidden_services)
    found = [name for name, types in services if args.service_type in types]
    if args.count_services:
        print(len(found))
        return 0
    for name in found:
        print(name)
    return 0
