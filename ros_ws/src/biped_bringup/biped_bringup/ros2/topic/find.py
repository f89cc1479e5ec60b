"""Output a list of available topics of a given type."""

from __future__ import annotations

import argparse

from biped_bringup.ros2 import completion
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
    completion.completed(
        parser.add_argument("topic_type", help="type, e.g. std_msgs/msg/String"),
        completion.message_names,
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


def main(args: argparse.Namespace) -> int:
    """Print the names of the topics."""
    with graph_node(args) as node:
        discover(args, until=settled(node))
        found = [
            name
            for name, types in topics_and_types(
                node, include_hidden=args.include_hidden_topics
            )
            if args.topic_type in types
        ]
    if args.count_topics:
        print(len(found))
    else:
        for name in found:
            print(name)
    return 0
