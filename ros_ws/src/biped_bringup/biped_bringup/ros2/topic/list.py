"""Output a list of available topics."""

from __future__ import annotations

import argparse

from rclpy.node import Node

from biped_bringup.ros2.graph_node import (
    add_graph_arguments,
    discover,
    graph_node,
    settled,
)
from biped_bringup.ros2.topics import topics_and_types


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    parser.add_argument(
        "-t",
        "--show-types",
        action="store_true",
        help="additionally show the topic type",
    )
    parser.add_argument(
        "-c",
        "--count-topics",
        action="store_true",
        help="only display the number of topics discovered",
    )
    parser.add_argument(
        "--include-hidden-topics",
        action="store_true",
        help="consider hidden topics as well",
    )
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="list full details about each topic",
    )


def main(args: argparse.Namespace) -> int:
    """Print the topics."""
    with graph_node(args) as node:
        discover(args, until=settled(node))
        topics = topics_and_types(node, include_hidden=args.include_hidden_topics)
        if args.count_topics:
            print(len(topics))
        elif args.verbose:
            _print_directions(node, topics)
        else:
            for name, types in topics:
                print(f"{name} [{', '.join(types)}]" if args.show_types else name)
    return 0


def _print_directions(node: Node, topics: list[tuple[str, list[str]]]) -> None:
    for title, noun, count in (
        ("Published", "publisher", node.count_publishers),
        ("Subscribed", "subscriber", node.count_subscribers),
    ):
        print(f"{title} topics:")
        for name, types in topics:
            if number := count(name):
                plural = "s" if number > 1 else ""
                print(f" * {name} [{', '.join(types)}] {number} {noun}{plural}")
        print()
