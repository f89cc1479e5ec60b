"""Display delay of topic from timestamp in header."""

from __future__ import annotations

import argparse
from collections import deque
from typing import Any

from rclpy.time import Time

from biped_common.timing import NS_PER_S
from ros2_verbs.errors import VerbError
from ros2_verbs.options import unsigned_int
from ros2_verbs.topic.measuring import (
    add_measuring_arguments,
    measure,
    measured_topic,
    spread_text,
)

_WINDOW = 10000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_measuring_arguments(parser, _WINDOW, unsigned_int)


def main(args: argparse.Namespace) -> int:
    """Print the delay once a second, until interrupted.

    Raises:
        VerbError: the messages have no header.
    """
    window = DelayWindow(args.window)
    with measured_topic(args) as (node, kind):
        if "header" not in kind.get_fields_and_field_types():
            raise VerbError("msg does not have header")
        clock = node.get_clock()

        def take(message: Any) -> None:
            now_ns = clock.now().nanoseconds
            if now_ns:  # 0 before simulated time begins
                window.arrived(now_ns, Time.from_msg(message.header.stamp).nanoseconds)

        measure(args, node, kind, take, raw=False, report=window.report)
    return 0


class DelayWindow:
    """Delay between stamp and arrival, over the last messages."""

    def __init__(self, size: int) -> None:
        """Begin without messages.

        Args:
            size: the most messages that count.
        """
        self._delays_ns: deque[int] = deque(maxlen=size)
        self._new = False

    def arrived(self, now_ns: int, stamp_ns: int) -> None:
        """Take in a message."""
        self._delays_ns.append(now_ns - stamp_ns)
        self._new = True

    def report(self) -> str | None:
        """Return what is to be printed, None before the first message."""
        if not self._delays_ns:
            return None
        if not self._new:
            return "no new messages"
        self._new = False
        mean_s = sum(self._delays_ns) / len(self._delays_ns) / NS_PER_S
        return f"average delay: {mean_s:.3f}\n{spread_text(self._delays_ns)}"
