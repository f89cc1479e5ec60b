"""Output a list of available topics."""

from __future__ import annotations

import argparse

from rclpy.node import Node

from ros2_verbs.listing import add_listing_arguments, listed, print_listed
from ros2_verbs.topics import add_hidden_topics_argument, topics_and_types


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_listing_arguments(parser, "topics")
    parser.add_argument(
        "-t",
        "--show-types",
        action="store_true",
        help="additionally show the topic type",
    )
    add_hidden_topics_argument(parser)
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="list full details about each topic",
    )


def main(args: argparse.Namespace) -> int:
    """Print the topics."""
    detailed = args.verbose and not args.only_count

    def look(node: Node) -> list[str]:
        topics = topics_and_types(node, include_hidden=args.include_hidden_topics)
        if detailed:
            return _directions(node, topics)
        return [
            f"{name} [{', '.join(types)}]" if args.show_types else name
            for name, types in topics
        ]

    print_listed(args, listed(args, look))
    return 0


def _directions(node: Node, topics: list[tuple[str, list[str]]]) -> list[str]:
    """Return who publishes and who subscribes, in lines."""
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
