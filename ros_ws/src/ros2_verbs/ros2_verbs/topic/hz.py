"""Print the average receiving rate to screen.

Times are those of arrival here, which the load of the machine shifts. Messages are not
deserialized unless a filter looks at them.
"""

from __future__ import annotations

import argparse
import time
from collections import deque
from collections.abc import Collection
from typing import Any

from biped_common.timing import NS_PER_S
from ros2_verbs.messages.filter import message_filter
from ros2_verbs.options import positive_int
from ros2_verbs.topic.measuring import (
    add_measuring_arguments,
    measure,
    measured_topic,
    spread_text,
)

_WINDOW = 10000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_measuring_arguments(parser, _WINDOW, positive_int)
    parser.add_argument(
        "--filter",
        metavar="EXPR",
        help="only measure messages for which this Python expression of m, the "
        "message, is true",
    )
    parser.add_argument(
        "--wall-time",
        action="store_true",
        help="measure in wall time, also with --use-sim-time",
    )


def main(args: argparse.Namespace) -> int:
    """Print the rate once a second, until interrupted."""
    accepts = message_filter(args.filter)
    window = RateWindow(args.window)
    with measured_topic(args) as (node, kind):
        clock = node.get_clock()
        in_sim_time = args.use_sim_time and not args.wall_time

        def take(message: Any) -> None:
            if accepts is not None and not accepts(message):
                return
            now_ns = clock.now().nanoseconds if in_sim_time else time.time_ns()
            report = window.arrived(now_ns)
            if report is not None:
                print(report)

        measure(args, node, kind, take, raw=accepts is None)
    return 0


class RateWindow:
    """Rate of arrival, over the last intervals, once a second."""

    def __init__(self, size: int) -> None:
        """Begin without messages.

        Args:
            size: the most intervals that count.
        """
        self._intervals_ns: deque[int] = deque(maxlen=size)
        self._first_ns: int | None = None
        self._last_ns = 0
        self._reported_ns = 0

    def arrived(self, now_ns: int) -> str | None:
        """Take in a message; return a report if it is time for one.

        Args:
            now_ns: time of arrival; where it goes back, all begins anew.
        """
        if now_ns == 0:  # simulated time has not begun
            return self._reset()
        if self._first_ns is None or now_ns < self._first_ns:
            self._intervals_ns.clear()
            self._first_ns = self._last_ns = self._reported_ns = now_ns
            return None
        self._intervals_ns.append(now_ns - self._last_ns)
        self._last_ns = now_ns
        if now_ns < self._reported_ns + NS_PER_S:
            return None
        self._reported_ns = now_ns
        return rate_report(self._intervals_ns)

    def _reset(self) -> str | None:
        had_some = bool(self._intervals_ns)
        self._intervals_ns.clear()
        self._first_ns = None
        return "time has reset, resetting counters" if had_some else None


def rate_report(intervals_ns: Collection[int]) -> str:
    """Return what is printed for at least one interval between messages."""
    total_ns = sum(intervals_ns)
    rate_hz = len(intervals_ns) * NS_PER_S / total_ns if total_ns > 0 else 0.0
    return f"average rate: {rate_hz:.3f}\n{spread_text(intervals_ns)}"
