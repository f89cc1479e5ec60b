"""Simulated time of messages: what /clock said when they were received."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message

from biped_bag.qos import RECORDED_DEPTH
from biped_bag.storage.contents import BagMessage
from biped_common.timing import nanoseconds
from biped_ros.messages import message_type
from msgs_json.topics import CLOCK


class SimTime:
    """A subscription to /clock of its own, so that it need not be recorded."""

    def __init__(self, listener: Node) -> None:
        """Listen.

        Args:
            listener: node for the subscription, in no executor.
        """
        # Whatever the publisher offers: some are best effort.
        profile = QoSProfile(
            depth=RECORDED_DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT
        )
        self._clock = message_type(CLOCK)
        self._subscription = listener.create_subscription(
            self._clock, CLOCK.name, lambda _: None, profile, raw=True
        )
        self._ticks: deque[tuple[int, int]] = deque(maxlen=RECORDED_DEPTH)
        """Wall time of reception and simulated time, from the one that holds on."""

    def stamped(self, messages: Iterable[BagMessage]) -> Iterator[BagMessage]:
        """Yield messages with simulated log times; none of before the first tick.

        Args:
            messages: by the wall time at which they were received, earlier ones than
                those of the last call excluded.
        """
        self._listen()
        ticks = self._ticks
        for message in messages:
            while len(ticks) > 1 and ticks[1][0] <= message.log_ns:
                ticks.popleft()
            if ticks and ticks[0][0] <= message.log_ns:
                yield message._replace(log_ns=ticks[0][1])

    def _listen(self) -> None:
        queue = self._subscription.handle
        with queue:  # keeps it from being destroyed
            while (taken := queue.take_message(self._clock, True)) is not None:
                data, about = taken
                time_ns = nanoseconds(deserialize_message(data, self._clock).clock)
                self._ticks.append((about["received_timestamp"], time_ns))
