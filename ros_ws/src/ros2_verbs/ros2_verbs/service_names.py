"""Names and types of services on the graph."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from ros2_verbs.graph_node import glance, graph_node


def add_hidden_argument(parser: argparse.ArgumentParser) -> None:
    """Add --include-hidden-services."""
    parser.add_argument(
        "--include-hidden-services",
        action="store_true",
        help="consider hidden services as well",
    )


def service_names_and_types(
    node: Node, *, hidden: bool
) -> list[tuple[str, Sequence[str]]]:
    """Return the services on the graph, sorted.

    Args:
        node: that has discovered the graph.
        hidden: with those of which a part of the name begins with an underscore.
    """
    return sorted(
        (name, types)
        for name, types in node.get_service_names_and_types()
        if hidden or not topic_or_service_is_hidden(name)
    )


def complete_service_names(
    prefix: str, parsed_args: argparse.Namespace, **_: Any
) -> Sequence[str]:
    """Return service names for the shell."""
    return [name for name, _ in _discovered(parsed_args)]


def complete_service_types(
    prefix: str, parsed_args: argparse.Namespace, **_: Any
) -> Sequence[str]:
    """Return the types of the service on the command line, or of all, for the shell."""
    named = getattr(parsed_args, "service_name", None)
    return sorted(
        {
            kind
            for name, types in _discovered(parsed_args)
            if named in (None, name)
            for kind in types
        }
    )


def _discovered(args: argparse.Namespace) -> list[tuple[str, Sequence[str]]]:
    with graph_node(args) as node:
        glance(node)
        return service_names_and_types(node, hidden=args.include_hidden_services)
