"""Output a list of available services."""

from __future__ import annotations

import argparse

from biped_bringup.ros2.graph_node import (
    add_graph_arguments,
    discover,
    graph_node,
    settled,
)
from biped_bringup.ros2.service_names import (
    add_hidden_argument,
    service_names_and_types,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    parser.add_argument(
        "-t",
        "--show-types",
        action="store_true",
        help="additionally show the service type",
    )
    parser.add_argument(
        "-c",
        "--count-services",
        action="store_true",
        help="only display the number of services discovered",
    )
    add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the services."""
    with graph_node(args) as node:
        discover(args, until=settled(node))
        services = service_names_and_types(node, hidden=args.include_hidden_services)
    if args.count_services:
        print(len(services))
        return 0
    for name, types in services:
        print(f"{name} [{', '.join(types)}]" if args.show_types else name)
    return 0
