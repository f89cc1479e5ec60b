"""Print information about a service."""

from __future__ import annotations

import argparse

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import SERVICES
from ros2_verbs.graph.session import graph_node
from ros2_verbs.options import add_graph_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    SERVICES.add_name_argument(parser)
    SERVICES.add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print type, and how many call and offer it.

    Raises:
        VerbError: there is no such service.
    """
    name = args.service_name
    with graph_node(args) as node:
        types = SERVICES.await_types(node, name, args, at_once=False)
        if not types:
            raise VerbError(f"Unknown service '{name}'")
        print(f"Type: {types[0] if len(types) == 1 else types}")
        print(f"Clients count: {node.count_clients(name)}")
        print(f"Services count: {node.count_services(name)}")
    return 0
