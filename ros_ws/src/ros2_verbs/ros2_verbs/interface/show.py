"""Output the interface definition."""

from __future__ import annotations

import argparse
import sys

from ros2_verbs import completion, message_types
from ros2_verbs.errors import VerbError
from ros2_verbs.interface_text import definition_lines


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    comments = parser.add_mutually_exclusive_group()
    comments.add_argument(
        "--all-comments",
        action="store_true",
        help="show all comments, including for nested interface definitions",
    )
    comments.add_argument(
        "--no-comments", action="store_true", help="show no comments or whitespace"
    )
    completion.completed(
        parser.add_argument(
            "type", help="type, e.g. std_msgs/msg/String; - reads it from a pipe"
        ),
        completion.interface_names,
    )


def main(args: argparse.Namespace) -> int:
    """Print the definition, nested ones below their fields."""
    name = args.type
    if name == "-":
        if sys.stdin.isatty():
            raise VerbError("expected stdin pipe")
        name = sys.stdin.readline().strip()
    for line in definition_lines(
        name.split("/")[0],
        message_types.definition_file(name).read_text(),
        comments=not args.no_comments,
        nested_comments=args.all_comments,
    ):
        print(line)
    return 0
