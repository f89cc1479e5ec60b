"""Display bandwidth used by topic."""

from __future__ import annotations

import argparse
import time

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
from biped_bringup.ros2.qos_options import listening_profile
from biped_bringup.ros2.topics import class_of_topic, is_known
from biped_bringup.ros2.window import BandwidthWindow

_WINDOW = 100
_REPORT_S = 1.0


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
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print the bandwidth once a second, until interrupted."""
    window = BandwidthWindow(args.window)
    finished: Future = Future()
    with graph_node(args) as node:
        discover(args, until=lambda: is_known(node, args.topic_name))
        kind = class_of_topic(node, args.topic_name, timeout_s=None, verb="measure")
        clock = node.get_clock()

        def now_ns() -> int:
            simulated = args.use_sim_time
            return int(clock.now().nanoseconds) if simulated else time.monotonic_ns()

        def take(message: bytes) -> None:
            window.arrived(now_ns(), len(message))

        def report() -> None:
            text = window.report(now_ns())
            if text is not None:
                print(text)

        node.create_subscription(
            kind,
            args.topic_name,
            caught(finished, take),
            listening_profile(node, args.topic_name, args),
            raw=True,
        )
        print(f"Subscribed to [{args.topic_name}]")
        node.create_timer(_REPORT_S, caught(finished, report))
        spin(node, finished)
    return 0
