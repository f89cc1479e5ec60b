"""Print information about a bag to the screen."""

from __future__ import annotations

import argparse

from biped_bag.info import info_text
from biped_bag.storage.reader import BagReader
from ros2_verbs.bag.shared import add_bag_argument, bag_errors


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_bag_argument(parser)
    parser.add_argument(
        "-t", "--topic-name", action="store_true", help="only display topic names"
    )


def main(args: argparse.Namespace) -> int:
    """Print what the bag holds.

    Raises:
        VerbError: it is no bag, or not whole.
    """
    with bag_errors():
        bag = BagReader(args.bag_path)
        if args.topic_name:
            for name in sorted(bag.topics):
                print(name)
        else:
            print(info_text(bag))
    return 0
