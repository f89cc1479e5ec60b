"""Print information about a topic."""

from __future__ import annotations

import argparse

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import TOPICS, full_topic_name, topic_types
from ros2_verbs.graph.session import discover, graph_node
from ros2_verbs.options import add_graph_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    TOPICS.add_name_argument(parser)
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="also print node, type hash, GID and QoS of each endpoint",
    )


def main(args: argparse.Namespace) -> int:
    """Print type and endpoints.

    Raises:
        VerbError: there is no such topic.
    """
    with graph_node(args) as node:
        name = full_topic_name(node, args.topic_name)
        discover(args, lambda: bool(topic_types(node, name)))
        types = topic_types(node, name)
        if not types:
            raise VerbError(f"Unknown topic '{args.topic_name}'")
        end = "\n\n" if args.verbose else "\n"
        print(f"Type: {types[0] if len(types) == 1 else types}", end=end)
        for noun, count, endpoints in (
            ("Publisher", node.count_publishers, node.get_publishers_info_by_topic),
            (
                "Subscription",
                node.count_subscribers,
                node.get_subscriptions_info_by_topic,
            ),
        ):
            print(f"{noun} count: {count(name)}", end=end)
            if args.verbose:
                for endpoint in endpoints(name):
                    # rclpy writes the endpoint as the original shows it.
                    print(endpoint, end=end)
    return 0
