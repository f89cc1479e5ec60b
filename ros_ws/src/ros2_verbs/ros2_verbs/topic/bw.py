"""Display bandwidth used by topic."""

from __future__ import annotations

import argparse
import time
from collections import deque

from biped_common.timing import NS_PER_S
from ros2_verbs.options import positive_int
from ros2_verbs.topic.measuring import add_measuring_arguments, measure, measured_topic

_WINDOW = 100


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_measuring_arguments(parser, _WINDOW, positive_int)


def main(args: argparse.Namespace) -> int:
    """Print the bandwidth once a second, until interrupted."""
    window = BandwidthWindow(args.window)
    with measured_topic(args) as (node, kind):
        clock = node.get_clock()

        def now_ns() -> int:
            simulated = args.use_sim_time
            return int(clock.now().nanoseconds) if simulated else time.monotonic_ns()

        def take(message: bytes) -> None:
            window.arrived(now_ns(), len(message))

        print(f"Subscribed to [{args.topic_name}]")
        measure(
            args, node, kind, take, raw=True, report=lambda: window.report(now_ns())
        )
    return 0


class BandwidthWindow:
    """Bytes per second, over the last messages."""

    def __init__(self, size: int) -> None:
        """Begin without messages.

        Args:
            size: the most messages that count.
        """
        self._arrivals: deque[tuple[int, int]] = deque(maxlen=size)

    def arrived(self, now_ns: int, size: int) -> None:
        """Take in a message of so many bytes."""
        self._arrivals.append((now_ns, size))

    def report(self, now_ns: int) -> str | None:
        """Return what is to be printed, None with fewer than two messages."""
        if len(self._arrivals) < 2:
            return None
        elapsed_ns = now_ns - self._arrivals[0][0]
        if elapsed_ns <= 0:
            self._arrivals.clear()
            return None
        sizes = [size for _, size in self._arrivals]
        rate = sum(sizes) * NS_PER_S / elapsed_ns
        unit = _unit(rate)
        mean, least, most = (
            _in_unit(size, unit)
            for size in (sum(sizes) / len(sizes), min(sizes), max(sizes))
        )
        return (
            f"{_in_unit(rate, unit)}/s from {len(sizes)} messages\n"
            f"\tMessage size mean: {mean} min: {least} max: {most}"
        )


def _unit(bytes_per_s: float) -> str:
    # One unit for the whole report: that of the bandwidth.
    if bytes_per_s < 1e3:
        return "B"
    return "KB" if bytes_per_s < 1e6 else "MB"


def _in_unit(size: float, unit: str) -> str:
    if unit == "B":
        return f"{size:.0f} B"
    return f"{size / (1e3 if unit == 'KB' else 1e6):.2f} {unit}"
