"""Print the average receiving rate to screen.

Times are those of arrival here, which the load of the machine shifts. Messages are not
deserialized unless a filter looks at them.
"""

from __future__ import annotations

import argparse
import time
from typing import Any

from rclpy.task import Future

from biped_bringup.ros2 import completion
from biped_bringup.ros2.arguments import positive_int
from biped_bringup.ros2.graph_node import (
    add_node_arguments,
    caught,
    discover,
    graph_node,
    spin,
)
from biped_bringup.ros2.message_filter import message_filter
from biped_bringup.ros2.qos_options import listening_profile
from biped_bringup.ros2.topics import class_of_topic, is_known
from biped_bringup.ros2.window import RateWindow

_WINDOW = 10000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    completion.completed(
        parser.add_argument("topic_name", help="topic, e.g. /joint_states"),
        completion.topic_names,
    )
    parser.add_argument(
        "-w",
        "--window",
        type=positive_int,
        default=_WINDOW,
        help=f"number of messages to average over (default: {_WINDOW})",
    )
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
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print the rate once a second, until interrupted."""
    accepts = message_filter(args.filter)
    window = RateWindow(args.window)
    finished: Future = Future()
    with graph_node(args) as node:
        discover(args, until=lambda: is_known(node, args.topic_name))
        kind = class_of_topic(node, args.topic_name, timeout_s=None, verb="measure")
        clock = node.get_clock()
        in_sim_time = args.use_sim_time and not args.wall_time

        def take(message: Any) -> None:
            if accepts is not None and not accepts(message):
                return
            now_ns = clock.now().nanoseconds if in_sim_time else time.time_ns()
            report = window.arrived(now_ns)
            if report is not None:
                print(report)

        node.create_subscription(
            kind,
            args.topic_name,
            caught(finished, take),
            listening_profile(node, args.topic_name, args),
            raw=accepts is None,
        )
        spin(node, finished)
    return 0
