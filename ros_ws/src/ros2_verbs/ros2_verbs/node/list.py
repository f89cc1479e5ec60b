"""Output a list of available nodes."""

from __future__ import annotations

import argparse
import sys

from ros2_verbs.graph.names import add_count_argument, node_names, print_listed
from ros2_verbs.graph.session import whole_graph
from ros2_verbs.options import add_graph_arguments

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
    add_count_argument(parser, "nodes")


def main(args: argparse.Namespace) -> int:
    """Print the nodes."""
    found = whole_graph(args, lambda node: node_names(node, hidden=args.all))
    names = sorted(name.full for name in found)
    if len(set(names)) < len(names) and not args.only_count:
        print(_TWINS, file=sys.stderr)
    print_listed(args, names)
    return 0
