"""Print a topic's type."""

from __future__ import annotations

import argparse

from ros2_verbs import completion
from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import add_graph_arguments, discover, graph_node
from ros2_verbs.topics import full_name, topics_and_types


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    completion.completed(
        parser.add_argument("topic_name", help="topic, e.g. /joint_states"),
        completion.topic_names,
    )
    parser.add_argument(
        "--include-hidden-topics",
        action="store_true",
        help="consider hidden topics as well",
    )


def main(args: argparse.Namespace) -> int:
    """Print the type, or the types."""
    with graph_node(args) as node:
        name = full_name(node, args.topic_name)

        def types() -> list[str]:
            known = topics_and_types(node, include_hidden=args.include_hidden_topics)
            return dict(known).get(name, [])

        if not discover(args, until=lambda: bool(types()), at_once=True):
            raise VerbError(f"Unknown topic '{args.topic_name}'")
        for type_name in types():
            print(type_name)
    return 0
