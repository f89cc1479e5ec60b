"""Output a list of available topics."""

from __future__ import annotations

import argparse

from rclpy.node import Node

from ros2_verbs.graph.endpoints import TOPICS, with_types
from ros2_verbs.graph.names import print_listed
from ros2_verbs.graph.session import whole_graph


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    TOPICS.add_listing_arguments(parser)
    TOPICS.add_show_types_argument(parser)
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="list full details about each topic",
    )


def main(args: argparse.Namespace) -> int:
    """Print the topics."""
    if args.verbose and not args.only_count:
        lines = whole_graph(
            args, lambda node: _directions(node, hidden=args.include_hidden)
        )
    else:
        lines = with_types(args, TOPICS.found(args))
    print_listed(args, lines)
    return 0


def _directions(node: Node, *, hidden: bool) -> list[str]:
    """Return who publishes and who subscribes, in lines."""
    topics = TOPICS.known(node, hidden=hidden)
    lines = []
    for title, noun, count in (
        ("Published", "publisher", node.count_publishers),
        ("Subscribed", "subscriber", node.count_subscribers),
    ):
        lines.append(f"{title} topics:")
        for name, types in topics:
            if number := count(name):
                plural = "s" if number > 1 else ""
                lines.append(f" * {name} [{', '.join(types)}] {number} {noun}{plural}")
        lines.append("")
    return lines
