"""Display delay of topic from timestamp in header."""

from __future__ import annotations

import argparse
from typing import Any

from rclpy.task import Future
from rclpy.time import Time

from biped_bringup.ros2 import completion
from biped_bringup.ros2.arguments import unsigned_int
from biped_bringup.ros2.errors import VerbError
from biped_bringup.ros2.graph_node import (
    add_node_arguments,
    caught,
    discover,
    graph_node,
    spin,
)
from biped_bringup.ros2.qos_options import listening_profile
from biped_bringup.ros2.topics import class_of_topic, is_known
from biped_bringup.ros2.window import DelayWindow

_WINDOW = 10000
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
        type=unsigned_int,
        default=_WINDOW,
        help=f"number of messages to average over (default: {_WINDOW})",
    )
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print the delay once a second, until interrupted."""
    window = DelayWindow(args.window)
    finished: Future = Future()
    with graph_node(args) as node:
        discover(args, until=lambda: is_known(node, args.topic_name))
        kind = class_of_topic(node, args.topic_name, timeout_s=None, verb="measure")
        if "header" not in kind.get_fields_and_field_types():
            raise VerbError("msg does not have header")
        clock = node.get_clock()

        def take(message: Any) -> None:
            now_ns = clock.now().nanoseconds
            if now_ns:  # 0 before simulated time begins
                window.arrived(now_ns, Time.from_msg(message.header.stamp).nanoseconds)

        def report() -> None:
            text = window.report()
            if text is not None:
                print(text)

        node.create_subscription(
            kind,
            args.topic_name,
            caught(finished, take),
            listening_profile(node, args.topic_name, args),
        )
        node.create_timer(_REPORT_S, caught(finished, report))
        spin(node, finished)
    return 0
