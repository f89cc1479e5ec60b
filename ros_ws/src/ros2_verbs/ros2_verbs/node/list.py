"""Output a list of available nodes."""

from __future__ import annotations

import argparse
import sys

from ros2_verbs.graph_node import (
    add_graph_arguments,
    discover,
    graph_node,
    settled,
)
from ros2_verbs.node_names import node_names

_TWINS = (
    "WARNING: Be aware that there are nodes in the graph that share an exact name, "
    "which can have unintended side effects."
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    parser.add_argument(
        "-a", "--all", action="store_true", help="display all nodes, even hidden ones"
    )
    parser.add_argument(
        "-c",
        "--count-nodes",
        action="store_true",
        help="only display the number of nodes discovered",
    )


def main(args: argparse.Namespace) -> int:
    """Print the nodes."""
    with graph_node(args) as node:
        discover(args, until=settled(node))
        names = sorted(name.full for name in node_names(node, hidden=args.all))
    if args.count_nodes:
        print(len(names))
        return 0
    if len(set(names)) < len(names):
        print(_TWINS, file=sys.stderr)
    for name in names:
        print(name)
    return 0
