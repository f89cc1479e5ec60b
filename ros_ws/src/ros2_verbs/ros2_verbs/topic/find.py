"""Output a list of available topics of a given type."""

from __future__ import annotations

import argparse

from ros2_verbs.graph.endpoints import TOPICS
from ros2_verbs.graph.names import print_listed
from ros2_verbs.messages.types import complete_message_types
from ros2_verbs.options import completed


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    TOPICS.add_listing_arguments(parser)
    completed(
        parser.add_argument("topic_type", help="type, e.g. std_msgs/msg/String"),
        complete_message_types,
    )


def main(args: argparse.Namespace) -> int:
    """Print the names of the topics."""
    topics = TOPICS.found(args)
    print_listed(args, [name for name, types in topics if args.topic_type in types])
    return 0
