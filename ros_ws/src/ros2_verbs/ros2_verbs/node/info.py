"""Output information about a node."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from rclpy.action import (
    get_action_client_names_and_types_by_node,
    get_action_server_names_and_types_by_node,
)
from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from biped_common.terminal_text import printable
from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import NamesAndTypes
from ros2_verbs.graph.names import NodeName, add_node_name_argument, node_names
from ros2_verbs.graph.session import discover, graph_node, settled
from ros2_verbs.options import add_graph_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    add_node_name_argument(parser)
    parser.add_argument(
        "--include-hidden",
        action="store_true",
        help="display hidden topics, services, and actions as well",
    )


def main(args: argparse.Namespace) -> int:
    """Print what a node publishes, subscribes to, offers and calls.

    Raises:
        VerbError: it is not on the graph.
    """
    wanted = NodeName.parse(args.node_name)

    def known() -> list[NodeName]:
        return node_names(node, hidden=args.include_hidden)

    with graph_node(args) as node:
        # What a node has may come later than its name.
        is_settled = settled(node)
        discover(args, lambda: is_settled() and wanted in known())
        twins = known().count(wanted)
        if not twins:
            raise VerbError(f"Unable to find node '{args.node_name}'")
        if twins > 1:
            print(
                f"There are {twins} nodes in the graph with the exact name "
                f'"{wanted.full}". You are seeing information about only one of them.',
                file=sys.stderr,
            )
        print(report(wanted, _sections(node, wanted), hidden=args.include_hidden))
    return 0


def report(
    name: NodeName, sections: Sequence[tuple[str, NamesAndTypes]], *, hidden: bool
) -> str:
    """Return the node's sections as text; an empty one leaves an empty line.

    Args:
        name: of the node.
        sections: title, and names with their types.
        hidden: with hidden names.
    """
    lines = [printable(name.full)]
    for title, entries in sections:
        lines.append(f"  {title}:")
        shown = [
            printable(f"    {entry}: {', '.join(types)}")
            for entry, types in entries
            if hidden or not topic_or_service_is_hidden(entry)
        ]
        lines += shown or [""]
    return "\n".join(lines)


def _sections(node: Node, of: NodeName) -> list[tuple[str, NamesAndTypes]]:
    by_node = (of.name, of.namespace)
    return [
        ("Subscribers", node.get_subscriber_names_and_types_by_node(*by_node)),
        ("Publishers", node.get_publisher_names_and_types_by_node(*by_node)),
        ("Service Servers", node.get_service_names_and_types_by_node(*by_node)),
        ("Service Clients", node.get_client_names_and_types_by_node(*by_node)),
        ("Action Servers", get_action_server_names_and_types_by_node(node, *by_node)),
        ("Action Clients", get_action_client_names_and_types_by_node(node, *by_node)),
    ]
