"""Output a list of available parameters."""

from __future__ import annotations

import argparse
import sys

from rclpy.node import Node

from biped_common.terminal_text import printable
from ros2_verbs.errors import VerbError
from ros2_verbs.graph.names import node_names
from ros2_verbs.graph.session import discover, graph_node, settled
from ros2_verbs.options import regular_expression
from ros2_verbs.param.services import (
    ParameterServices,
    add_asked_node_arguments,
    connect,
    type_name,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_asked_node_arguments(parser, nargs="?")
    parser.add_argument(
        "--param-prefixes",
        nargs="+",
        default=[],
        metavar="PREFIX",
        help="only list parameters with the provided prefixes",
    )
    parser.add_argument(
        "--param-type",
        action="store_true",
        help="print parameter types with parameter names",
    )
    parser.add_argument(
        "--filter",
        type=regular_expression,
        metavar="REGEX",
        help="only list parameters matching the provided regular expression",
    )


def main(args: argparse.Namespace) -> int:
    """Print the parameters of one node, or of all under their names.

    A node of all that does not answer is named on stderr; the others are still listed.

    Raises:
        VerbError: the one node is not there or does not answer.
    """
    with graph_node(args) as node:
        if args.node_name:
            print(*map(printable, _lines(args, connect(node, args))), sep="\n")
            return 0
        discover(args, settled(node))
        status = 0
        for name in _nodes_with_parameters(node, hidden=args.include_hidden_nodes):
            try:
                lines = _lines(args, ParameterServices(node, name))
            except VerbError as error:
                print(error, file=sys.stderr)
                status = 1
            else:
                print(*map(printable, [f"{name}:", *lines]), sep="\n")
    return status


def _lines(args: argparse.Namespace, services: ParameterServices) -> list[str]:
    names = [
        name
        for name in services.names(args.param_prefixes)
        if args.filter is None or args.filter.search(name)
    ]
    if not args.param_type or not names:
        return [f"  {name}" for name in names]
    return [
        f"  {descriptor.name} (type: {type_name(descriptor.type)})"
        for descriptor in services.descriptors(names)
    ]


def _nodes_with_parameters(node: Node, *, hidden: bool) -> list[str]:
    services = {name for name, _ in node.get_service_names_and_types()}
    return sorted(
        {
            name.full
            for name in node_names(node, hidden=hidden)
            if f"{name.full}/list_parameters" in services
        }
    )
