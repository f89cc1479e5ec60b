"""Print the average receiving rate to screen.

Times are those of arrival here, which the load of the machine shifts. Messages are not
deserialized unless a filter looks at them.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

from ros2_verbs.arguments import positive_int
from ros2_verbs.measuring import add_measuring_arguments, measured_topic
from ros2_verbs.message_filter import message_filter
from ros2_verbs.window import RateWindow

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
    with measured_topic(args) as topic:
        clock = topic.node.get_clock()
        in_sim_time = args.use_sim_time and not args.wall_time

        def take(message: Any) -> None:
            if accepts is not None and not accepts(message):
                return
            now_ns = clock.now().nanoseconds if in_sim_time else time.time_ns()
            report = window.arrived(now_ns)
            if report is not None:
                print(report)

        topic.measure(take, raw=accepts is None)
    return 0
