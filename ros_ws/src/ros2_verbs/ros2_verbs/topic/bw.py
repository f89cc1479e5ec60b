"""Display bandwidth used by topic."""

from __future__ import annotations

import argparse
import time

from ros2_verbs.arguments import positive_int
from ros2_verbs.measuring import add_measuring_arguments, measured_topic
from ros2_verbs.window import BandwidthWindow

_WINDOW = 100


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_measuring_arguments(parser, _WINDOW, positive_int)


def main(args: argparse.Namespace) -> int:
    """Print the bandwidth once a second, until interrupted."""
    window = BandwidthWindow(args.window)
    with measured_topic(args) as topic:
        clock = topic.node.get_clock()

        def now_ns() -> int:
            simulated = args.use_sim_time
            return int(clock.now().nanoseconds) if simulated else time.monotonic_ns()

        def take(message: bytes) -> None:
            window.arrived(now_ns(), len(message))

        print(f"Subscribed to [{args.topic_name}]")
        topic.measure(take, raw=True, report=lambda: window.report(now_ns()))
    return 0
