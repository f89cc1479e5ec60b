"""Display delay of topic from timestamp in header."""

from __future__ import annotations

import argparse
from typing import Any

from rclpy.time import Time

from ros2_verbs.arguments import unsigned_int
from ros2_verbs.errors import VerbError
from ros2_verbs.measuring import add_measuring_arguments, measured_topic
from ros2_verbs.window import DelayWindow

_WINDOW = 10000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_measuring_arguments(parser, _WINDOW, unsigned_int)


def main(args: argparse.Namespace) -> int:
    """Print the delay once a second, until interrupted."""
    window = DelayWindow(args.window)
    with measured_topic(args) as topic:
        if "header" not in topic.kind.get_fields_and_field_types():
            raise VerbError("msg does not have header")
        clock = topic.node.get_clock()

        def take(message: Any) -> None:
            now_ns = clock.now().nanoseconds
            if now_ns:  # 0 before simulated time begins
                window.arrived(now_ns, Time.from_msg(message.header.stamp).nanoseconds)

        topic.measure(take, raw=False, report=window.report)
    return 0
