"""Output a service's type."""

from __future__ import annotations

import argparse

from ros2_verbs.graph.endpoints import SERVICES
from ros2_verbs.graph.session import graph_node
from ros2_verbs.options import add_graph_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    SERVICES.add_name_argument(parser)
    SERVICES.add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the types of a service; fail in silence when there is none, as Jazzy's."""
    with graph_node(args) as node:
        types = SERVICES.await_types(node, args.service_name, args)
    for type_name in types:
        print(type_name)
    return 0 if types else 1
