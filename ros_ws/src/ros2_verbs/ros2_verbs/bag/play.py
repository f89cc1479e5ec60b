"""Play back ROS data from a bag."""

from __future__ import annotations

import argparse
import os
import sys

from biped_bag.keyboard import has_keyboard
from biped_bag.player.play import PlayRequest, play
from biped_bag.selection import Selection, from_root
from biped_bag.storage.reader import BagReader
from biped_common.command_line import DONE, INTERRUPTED
from biped_common.signals import stop_requests
from biped_common.timing import NS_PER_S
from biped_ros.environment import node_environment
from ros2_verbs.bag.shared import add_bag_argument, bag_errors
from ros2_verbs.environment import discovery_range, domain_text
from ros2_verbs.errors import VerbError
from ros2_verbs.options import positive_float, regular_expression, unsigned_int

_CLOCK_HZ = 40.0
_KEYS = (
    "SPACE for Pause/Resume",
    "CURSOR_RIGHT for Play Next Message",
    "CURSOR_UP for Increase Rate 10%",
    "CURSOR_DOWN for Decrease Rate 10%",
)


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
        default=[],
        help="topics to replay, separated by space (default: all)",
    )
    parser.add_argument(
        "-e",
        "--regex",
        type=regular_expression,
        help="replay topics whose name as a whole matches the regular expression",
    )
    parser.add_argument(
        "-x",
        "--exclude-regex",
        type=regular_expression,
        help="do not replay topics whose name as a whole matches it",
    )
    parser.add_argument(
        "--exclude-topics",
        nargs="+",
        default=[],
        metavar="TOPIC",
        help="topics not to replay, separated by space",
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
        type=_remap,
        nargs="+",
        default=[],
        metavar="OLD:=NEW",
        help="topics to publish under other names",
    )
    parser.add_argument(
        "--clock",
        type=positive_float,
        nargs="?",
        const=_CLOCK_HZ,
        metavar="HZ",
        help=f"publish to /clock so often a second (default: {_CLOCK_HZ:g})",
    )
    parser.add_argument(
        "-d",
        "--delay",
        type=positive_float,
        default=0.0,
        metavar="SECONDS",
        help="wait so long before each pass",
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
    until = parser.add_mutually_exclusive_group()
    until.add_argument(
        "--playback-until-sec",
        dest="until_ns",
        type=_nanoseconds,
        metavar="SECONDS",
        help="play until this time, in seconds since the epoch",
    )
    until.add_argument(
        "--playback-until-nsec",
        dest="until_ns",
        type=unsigned_int,
        metavar="NANOSECONDS",
        help="play until this time, in nanoseconds since the epoch",
    )
    parser.add_argument(
        "--disable-keyboard-controls",
        action="store_true",
        help="do not listen to the keyboard",
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
        until_ns=args.until_ns,
        delay_s=args.delay,
        selection=Selection(
            names=from_root(args.topics),
            pattern=args.regex,
            excluded_names=from_root(args.exclude_topics),
            excluded_pattern=args.exclude_regex,
            include_hidden=True,
        ),
        remaps=dict(args.remap),
        clock_period_ns=_clock_period_ns(args),
        paused=args.start_paused,
        loop=args.loop,
        keyboard=not args.disable_keyboard_controls,
    )
    domain = _domain(domain_text())
    with bag_errors(), stop_requests() as stops:
        bag = BagReader(args.bag_path)
        if request.keyboard and has_keyboard():
            for line in _KEYS:
                _tell(f"Press {line}")
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
        raise argparse.ArgumentTypeError(f"{text}: must have the form OLD:=NEW")
    return source, target


def _nanoseconds(text: str) -> int:
    return round(positive_float(text) * NS_PER_S)


def _clock_period_ns(args: argparse.Namespace) -> int | None:
    """Return the recorded time between messages that come so often a second."""
    if args.clock is None:
        return None
    period_ns: int = round(args.rate * NS_PER_S / args.clock)
    return max(1, period_ns)


def _domain(text: str) -> int:
    if not text.isdecimal():
        raise VerbError(f"ROS_DOMAIN_ID is {text}, must be a number")
    return int(text)
