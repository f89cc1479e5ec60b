"""A node that refuses bad messages, counts them and says so in /diagnostics.

What a handler cannot understand or must not act on never reaches robot or memory: the
handler raises, the message is counted under its topic, and the first of its kind and
then one a second is logged.
"""

from __future__ import annotations

import importlib
from collections import Counter
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rclpy.node import Node
from rclpy.publisher import Publisher

from msgs_json import topics
from msgs_json.refusal import RefusedMessageError
from msgs_json.ros.qos import qos_profile
from msgs_json.topics import Topic
from msgs_json.wire import MalformedMessageError

_DIAGNOSTICS_PERIOD_S = 1.0


class GuardedNode(Node):  # type: ignore[misc]
    """Base of the project's nodes."""

    def __init__(self, name: str, **options: Any) -> None:
        """Make the node and its diagnostics.

        Args:
            name: of the node.
            options: of `rclpy.node.Node`.
        """
        super().__init__(name, **options)
        self.counts: Counter[str] = Counter()
        """Messages received, refused and malformed, by topic."""
        self.failure: str | None = None
        """Set by a node that cannot go on: why."""
        self._worst = DiagnosticStatus.OK
        self._remarks: dict[str, str] = {}
        self._diagnostics = self.publisher(topics.DIAGNOSTICS)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._publish_diagnostics)

    def close(self) -> None:
        """Let go of what is not ROS's; nodes override it."""

    def publisher(self, topic: Topic) -> Publisher:
        """Return a publisher of a topic of the graph."""
        return self.create_publisher(
            message_type(topic), topic.name, qos_profile(topic)
        )

    def listen(self, topic: Topic, handle: Callable[[bytes], None]) -> None:
        """Hand every message of a topic, as serialized bytes, to a guarded handler."""

        def guarded(message: bytes) -> None:
            self.counts[f"{topic.name} received"] += 1
            try:
                handle(bytes(message))
            except RefusedMessageError as error:
                self.refuse(topic, "refused", error)
            except MalformedMessageError as error:
                self.refuse(topic, "malformed", error)

        self.create_subscription(
            message_type(topic), topic.name, guarded, qos_profile(topic), raw=True
        )

    def refuse(self, topic: Topic, kind: str, error: Exception) -> None:
        """Count a message that was not acted on."""
        self.counts[f"{topic.name} {kind}"] += 1
        self.remark(DiagnosticStatus.WARN, f"{topic.name} {kind}", str(error))
        self.get_logger().warning(
            f"{topic.name}: {kind}: {error}", throttle_duration_sec=1.0
        )

    def remark(self, level: bytes, key: str, text: str) -> None:
        """Put a remark into the next diagnostics, with its severity."""
        self._worst = max(self._worst, level)
        self._remarks[key] = text

    def figures(self) -> dict[str, str]:
        """Return what the node adds to its diagnostics; nodes override it."""
        return {}

    def _publish_diagnostics(self) -> None:
        status = DiagnosticStatus(
            level=self._worst,
            name=self.get_name(),
            hardware_id="simulation",
            message="; ".join(self._remarks.values()) or "running",
        )
        figures = {**{k: str(n) for k, n in self.counts.items()}, **self.figures()}
        status.values = [KeyValue(key=k, value=v) for k, v in figures.items()]
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)
        self._worst = DiagnosticStatus.OK
        self._remarks.clear()


def message_type(topic: Topic) -> Any:
    """Return the message class of a topic."""
    package, _, name = topic.type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)
