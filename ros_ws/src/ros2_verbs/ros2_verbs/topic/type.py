"""Print a topic's type."""

from __future__ import annotations

import argparse

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import TOPICS, full_topic_name
from ros2_verbs.graph.session import graph_node
from ros2_verbs.options import add_graph_arguments


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    TOPICS.add_name_argument(parser)
    TOPICS.add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the type, or the types.

    Raises:
        VerbError: there is no such topic.
    """
    with graph_node(args) as node:
        name = full_topic_name(node, args.topic_name)
        types = TOPICS.await_types(node, name, args)
    if not types:
        raise VerbError(f"Unknown topic '{args.topic_name}'")
    for type_name in types:
        print(type_name)
    return 0
