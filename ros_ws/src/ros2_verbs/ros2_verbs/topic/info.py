"""Print information about a topic."""

from __future__ import annotations

import argparse

from ros2_verbs import completion
from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import add_graph_arguments, discover, graph_node
from ros2_verbs.topics import full_name, is_known


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    completion.completed(
        parser.add_argument("topic_name", help="topic, e.g. /joint_states"),
        completion.topic_names,
    )
    parser.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="also print node, type hash, GID and QoS of each endpoint",
    )


def main(args: argparse.Namespace) -> int:
    """Print type and endpoints."""
    with graph_node(args) as node:
        discover(args, until=lambda: is_known(node, args.topic_name))
        name = full_name(node, args.topic_name)
        types = dict(node.get_topic_names_and_types()).get(name)
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
