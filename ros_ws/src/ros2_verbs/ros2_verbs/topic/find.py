"""Output a list of available topics of a given type."""

from __future__ import annotations

import argparse

from ros2_verbs import completion
from ros2_verbs.listing import add_listing_arguments, listed, print_listed
from ros2_verbs.topics import add_hidden_topics_argument, topics_and_types


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_listing_arguments(parser, "topics")
    completion.completed(
        parser.add_argument("topic_type", help="type, e.g. std_msgs/msg/String"),
        completion.message_names,
    )
    add_hidden_topics_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the names of the topics."""
    hidden = args.include_hidden_topics
    topics = listed(args, lambda node: topics_and_types(node, include_hidden=hidden))
    print_listed(args, [name for name, types in topics if args.topic_type in types])
    return 0
