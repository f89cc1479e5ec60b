"""Play back ROS data from a bag."""

from __future__ import annotations

import argparse
import os
import sys

from biped_bag.player.play import PlayRequest, play
from biped_bag.storage.reader import BagReader
from biped_common.command_line import DONE, INTERRUPTED
from biped_common.signals import stop_requests
from biped_ros.environment import node_environment
from ros2_verbs.bag.shared import add_bag_argument, bag_errors
from ros2_verbs.environment import discovery_range, domain_text
from ros2_verbs.errors import VerbError
from ros2_verbs.options import positive_float


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_bag_argument(parser)
    parser.add_argument(
        "-r",
        "--rate",
        type=positive_float,
        default=1.0,
        help="rate at which to play back messages (default: 1)",
    )
    parser.add_argument(
        "--topics",
        nargs="+",
        metavar="TOPIC",
        help="topics to replay, separated by space (default: all)",
    )
    parser.add_argument(
        "-l",
        "--loop",
        action="store_true",
        help="start back at the beginning on reaching the end",
    )
    parser.add_argument(
        "-m",
        "--remap",
        nargs="+",
        default=[],
        metavar="OLD:=NEW",
        help="topics to publish under other names",
    )
    parser.add_argument(
        "--clock",
        action="store_true",
        help="publish to /clock, 100 times a recorded second",
    )
    parser.add_argument(
        "-p", "--start-paused", action="store_true", help="start paused"
    )
    parser.add_argument(
        "--start-offset",
        type=_offset,
        default=0.0,
        metavar="SECONDS",
        help="start the playback so many seconds into the bag",
    )
    parser.add_argument(
        "--playback-duration",
        type=positive_float,
        metavar="SECONDS",
        help="play so many seconds of the bag (default: to its end)",
    )


def main(args: argparse.Namespace) -> int:
    """Play to the end, or until interrupted.

    Raises:
        VerbError: it is no bag, is not whole, or has nothing of what is asked for.
    """
    request = PlayRequest(
        rate=args.rate,
        start_s=args.start_offset,
        duration_s=args.playback_duration,
        topics=None if args.topics is None else tuple(args.topics),
        remaps=dict(_remap(text) for text in args.remap),
        clock=args.clock,
        paused=args.start_paused,
        loop=args.loop,
    )
    domain = _domain(domain_text())
    with bag_errors(), stop_requests() as stops:
        bag = BagReader(args.bag_path)
        os.environ.update(node_environment(domain, discovery_range()))
        play(bag, request, domain, lambda: bool(stops), _tell)
    return INTERRUPTED if stops else DONE


def _tell(line: str) -> None:
    print(line, file=sys.stderr, flush=True)


def _offset(text: str) -> float:
    return 0.0 if text in ("0", "0.0") else positive_float(text)


def _remap(text: str) -> tuple[str, str]:
    source, separator, target = text.partition(":=")
    if not (source and separator and target):
        raise VerbError(f"--remap {text}: must have the form OLD:=NEW")
    return source, target


def _domain(text: str) -> int:
    if not text.isdecimal():
        raise VerbError(f"ROS_DOMAIN_ID is {text}, must be a number")
    return int(text)
