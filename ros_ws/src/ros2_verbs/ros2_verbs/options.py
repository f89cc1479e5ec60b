"""Options of many verbs, and the kinds of numbers that they take; without rclpy."""

from __future__ import annotations

import argparse
import math
import re
from collections.abc import Callable, Sequence
from typing import Any

from biped_common.terminal_text import printable

DISCOVERY_S = 0.5


def add_graph_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --spin-time, --use-sim-time and --no-daemon."""
    parser.add_argument(
        "--no-daemon",
        action="store_true",
        help="accepted for compatibility: there is no daemon here",
    )
    add_node_arguments(parser)


def add_node_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --spin-time and --use-sim-time."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=DISCOVERY_S,
        metavar="SECONDS",
        help=f"time to wait for discovery (default: {DISCOVERY_S} s)",
    )
    parser.add_argument(
        "-s", "--use-sim-time", action="store_true", help="take time from /clock"
    )


def completed(action: argparse.Action, completer: Callable[..., Sequence[str]]) -> None:
    """Have argcomplete ask a function for an argument's values.

    Those that would act on the terminal are not offered.
    """

    def fit(**asked: Any) -> list[str]:
        offered = completer(**asked)
        return [word for word in offered if printable(word, layout=True) == word]

    # argcomplete looks for this attribute, which argparse does not declare.
    action.completer = fit  # type: ignore[attr-defined]


def regular_expression(text: str) -> re.Pattern[str]:
    """Compile a regular expression."""
    try:
        return re.compile(text)
    except re.error as error:
        raise argparse.ArgumentTypeError(f"{text}: {error}") from None


def positive_int(text: str) -> int:
    """Parse a whole number above 0."""
    return _checked_int(text, 1, "a positive integer")


def unsigned_int(text: str) -> int:
    """Parse a whole number that is not negative."""
    return _checked_int(text, 0, "a non-negative integer")


def positive_float(text: str) -> float:
    """Parse a finite number above 0."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"{text}: must be a positive number")
    return value


def _checked_int(text: str, least: int, kind: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise argparse.ArgumentTypeError(f"{text}: must be {kind}")
    return value
