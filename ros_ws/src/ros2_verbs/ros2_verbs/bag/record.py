"""Record ROS data to a bag."""

from __future__ import annotations

import argparse
import re
import time
from collections.abc import Callable
from contextlib import nullcontext
from functools import partial
from pathlib import Path

from biped_bag.keyboard import Key, has_keyboard, keyboard
from biped_bag.recorder.node import RecorderNode
from biped_bag.recorder.settings import RecorderSettings
from biped_ros.parameters import parameters_of
from biped_ros.running import run_node
from ros2_verbs.bag.shared import add_storage_argument, bag_errors
from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import TOPICS
from ros2_verbs.options import completed, regular_expression, unsigned_int

_BYTES_PER_MB = 1_000_000
_KEYS_PERIOD_S = 0.05
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
        type=regular_expression,
        help="record topics containing the regular expression; --all overrides it",
    )
    parser.add_argument(
        "-x",
        "--exclude-regex",
        type=regular_expression,
        help="do not record topics containing the regular expression",
    )
    parser.add_argument(
        "--topic-types",
        nargs="+",
        default=[],
        metavar="TYPE",
        help="types of topics to record, separated by space",
    )
    completed(
        parser.add_argument(
            "--exclude-topics",
            nargs="+",
            default=[],
            metavar="TOPIC",
            help="topics not to record, separated by space",
        ),
        TOPICS.complete_names,
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
    parser.add_argument(
        "--use-sim-time",
        action="store_true",
        help="log times are those of /clock; nothing is recorded before its first",
    )
    parser.add_argument(
        "--start-paused",
        action="store_true",
        help="record nothing until SPACE is pressed, or the service "
        "/recorder_node/resume called",
    )
    parser.add_argument(
        "--disable-keyboard-controls",
        action="store_true",
        help="do not listen to the keyboard",
    )


def main(args: argparse.Namespace) -> int:
    """Record until interrupted.

    Raises:
        VerbError: nothing was chosen, or the folder is there already.
    """
    listens = has_keyboard() and not args.disable_keyboard_controls
    with bag_errors(), keyboard() if listens else nullcontext(list) as keys:
        settings = settings_of(args)

        def make() -> RecorderNode:
            node = RecorderNode(parameter_overrides=parameters_of(settings))
            if listens:
                node.get_logger().info("Press SPACE for pausing/resuming")
                node.create_timer(_KEYS_PERIOD_S, partial(_obey, keys, node))
            return node

        return run_node(make)


def settings_of(args: argparse.Namespace) -> RecorderSettings:
    """Return the recorder's settings that the options describe.

    Raises:
        VerbError: nothing was chosen, or the folder is there already.
    """
    names = [*args.topics, *args.more_topics]
    if not (args.all or names or args.topic_types or args.regex):
        raise VerbError(
            "Need to specify at least one option out of --all, --topics, "
            "--topic-types or --regex"
        )
    if args.exclude_topics and not (args.all or args.topic_types or args.regex):
        raise VerbError(
            "--exclude-topics argument requires either --all, --topic-types or --regex"
        )
    folder = args.output or Path(time.strftime(_DEFAULT_NAME))
    if folder.exists():
        raise VerbError(f"Output folder '{folder}' already exists.")
    return RecorderSettings(
        folder=str(folder),
        topics="" if args.all else " ".join(names),
        regex="" if args.all else _containing(args.regex),
        topic_types="" if args.all else " ".join(args.topic_types),
        exclude_topics=" ".join(args.exclude_topics),
        exclude_regex=_containing(args.exclude_regex),
        sim_time=args.use_sim_time,
        start_paused=args.start_paused,
        include_hidden=args.include_hidden_topics,
        split="size" if args.max_bag_size else "none",
        max_file_mb=max(1, -(-args.max_bag_size // _BYTES_PER_MB)),
    )


def _containing(pattern: re.Pattern[str] | None) -> str:
    # The recorder's patterns match names as a whole.
    return f".*(?:{pattern.pattern}).*" if pattern and pattern.pattern else ""


def _obey(keys: Callable[[], list[Key]], node: RecorderNode) -> None:
    for key in keys():
        if key is Key.SPACE:
            node.toggle_paused()
