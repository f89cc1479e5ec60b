"""Options that say how much of a message is shown, and in what form."""

from __future__ import annotations

import argparse

from ros2_verbs.messages.text import Shown
from ros2_verbs.options import unsigned_int

_LENGTH = 128


def add_shown_arguments(parser: argparse.ArgumentParser) -> None:
    """Add -f, -l, --no-arr, --no-str and --flow-style."""
    parser.add_argument(
        "-f",
        "--full-length",
        action="store_true",
        help="do not cut long arrays, bytes and strings",
    )
    parser.add_argument(
        "-l",
        "--truncate-length",
        type=unsigned_int,
        default=_LENGTH,
        metavar="N",
        help=f"cut arrays, bytes and strings to this length (default: {_LENGTH})",
    )
    parser.add_argument(
        "--no-arr", action="store_true", help="do not print the elements of arrays"
    )
    parser.add_argument(
        "--no-str", action="store_true", help="do not print the text of strings"
    )
    parser.add_argument(
        "--flow-style", action="store_true", help="YAML in flow style, on one line"
    )


def shown_of(args: argparse.Namespace) -> Shown:
    """Return how much the options let one see."""
    return Shown(
        length=None if args.full_length else args.truncate_length,
        arrays=not args.no_arr,
        strings=not args.no_str,
    )
