"""Publish 1, 2, 3, ... at 500 Hz on two topics, and note when each was sent.

    python -m benchmarks.numbered_publisher FILE

FILE is an array of wall-clock times [ns] by number and topic; 0 was not sent yet.
"""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path
from typing import Literal

import numpy as np
import rclpy
from numpy.typing import NDArray
from std_msgs.msg import UInt64

TOPICS = ("/numbers/a", "/numbers/b")
PERIOD_NS = 2_000_000
CAPACITY = 1_000_000
"""Numbers, enough for half an hour."""
_DEPTH = 1000


def sent_times(file: Path, mode: Literal["r", "w+"] = "r") -> NDArray[np.int64]:
    """Return the (CAPACITY, topics) times of sending, shared with who publishes."""
    shape = (CAPACITY, len(TOPICS))
    return np.memmap(file, dtype=np.int64, mode=mode, shape=shape)


def main(file: Path) -> None:
    """Publish until SIGTERM."""
    stops: list[int] = []
    rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    signal.signal(signal.SIGTERM, lambda number, _: stops.append(number))
    sent = sent_times(file, "w+")
    node = rclpy.create_node("numbered_publisher")
    publishers = [node.create_publisher(UInt64, topic, _DEPTH) for topic in TOPICS]
    due_ns = time.monotonic_ns()
    number = 0
    while not stops and number + 1 < CAPACITY:
        number += 1
        for i, publisher in enumerate(publishers):
            sent[number, i] = time.time_ns()
            publisher.publish(UInt64(data=number))
        due_ns += PERIOD_NS
        time.sleep(max(0, due_ns - time.monotonic_ns()) * 1e-9)
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main(Path(sys.argv[1]))
