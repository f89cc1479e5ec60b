"""Record ROS data to a bag."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from biped_bag.recorder.node import RecorderNode
from biped_bag.recorder.settings import RecorderSettings
from biped_ros.parameters import parameters_of
from biped_ros.running import run_node
from ros2_verbs.bag.shared import add_storage_argument, bag_errors
from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import TOPICS
from ros2_verbs.options import completed, unsigned_int

_BYTES_PER_MB = 1_000_000
_DEFAULT_NAME = "rosbag2_%Y_%m_%d-%H_%M_%S"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    completed(
        parser.add_argument("topics", nargs="*", help="topics to record"),
        TOPICS.complete_names,
    )
    completed(
        parser.add_argument(
            "--topics",
            dest="more_topics",
            nargs="+",
            default=[],
            metavar="TOPIC",
            help="topics to record, separated by space",
        ),
        TOPICS.complete_names,
    )
    parser.add_argument(
        "-a",
        "--all",
        "--all-topics",
        action="store_true",
        help="record all topics but hidden ones",
    )
    parser.add_argument(
        "-e",
        "--regex",
        default="",
        help="record topics containing the regular expression; --all overrides it",
    )
    parser.add_argument(
        "-x",
        "--exclude-regex",
        default="",
        help="do not record topics containing the regular expression",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        help="bag to create (default: a timestamped folder in the current directory)",
    )
    add_storage_argument(parser)
    parser.add_argument(
        "-b",
        "--max-bag-size",
        type=unsigned_int,
        default=0,
        metavar="BYTES",
        help="size, rounded up to whole megabytes, at which the next file is begun "
        "(default: 0, never)",
    )
    parser.add_argument(
        "--include-hidden-topics",
        action="store_true",
        help="record topics with a name part that begins with _ as well",
    )


def main(args: argparse.Namespace) -> int:
    """Record until interrupted.

    Raises:
        VerbError: nothing was chosen, or the folder is there already.
    """
    with bag_errors():
        settings = settings_of(args)
        return run_node(
            lambda: RecorderNode(parameter_overrides=parameters_of(settings))
        )


def settings_of(args: argparse.Namespace) -> RecorderSettings:
    """Return the recorder's settings that the options describe.

    Raises:
        VerbError: nothing was chosen, or the folder is there already.
    """
    names = [*args.topics, *args.more_topics]
    if not (args.all or names or args.regex):
        raise VerbError(
            "Need to specify at least one option out of --all, --topics or --regex"
        )
    folder = args.output or Path(time.strftime(_DEFAULT_NAME))
    if folder.exists():
        raise VerbError(f"Output folder '{folder}' already exists.")
    return RecorderSettings(
        folder=str(folder),
        topics="" if args.all else " ".join(names),
        regex="" if args.all else _containing(args.regex),
        exclude_regex=_containing(args.exclude_regex),
        include_hidden=args.include_hidden_topics,
        split="size" if args.max_bag_size else "none",
        max_file_mb=max(1, -(-args.max_bag_size // _BYTES_PER_MB)),
    )


def _containing(pattern: str) -> str:
    # The recorder's patterns match names as a whole.
    return f".*(?:{pattern}).*" if pattern else ""
