"""Output a list of available parameters."""

from __future__ import annotations

import argparse
import re
import sys

from rclpy.node import Node

from ros2_verbs.completion import completed
from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import (
    add_graph_arguments,
    discover,
    graph_node,
    settled,
)
from ros2_verbs.node_names import complete_node_names, node_names, require_node
from ros2_verbs.parameter_services import (
    ParameterServices,
    add_hidden_and_timeout_arguments,
)
from ros2_verbs.parameter_text import type_name


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    completed(
        parser.add_argument(
            "node_name",
            nargs="?",
            help="name of the ROS node; without it, of all nodes",
        ),
        complete_node_names,
    )
    add_hidden_and_timeout_arguments(parser)
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
        type=_pattern,
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
            wanted = require_node(
                node,
                args.node_name,
                hidden=args.include_hidden_nodes,
                timeout_s=args.timeout,
            )
            print(*_lines(args, ParameterServices(node, wanted.full)), sep="\n")
            return 0
        discover(args, until=settled(node))
        status = 0
        for name in _nodes_with_parameters(node, hidden=args.include_hidden_nodes):
            try:
                lines = _lines(args, ParameterServices(node, name))
            except VerbError as error:
                print(error, file=sys.stderr)
                status = 1
            else:
                print(f"{name}:", *lines, sep="\n")
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


def _pattern(text: str) -> re.Pattern[str]:
    try:
        return re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(f"{text}: {error}") from None
