"""A node that refuses bad messages, counts them and says so in /diagnostics.

What a handler cannot understand or must not act on never reaches robot or memory: the
handler raises, the message is counted under its topic, and the first of its kind and
then one a second is logged. A change of parameters that is refused says which and why.
"""

from __future__ import annotations

import importlib
import time
from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import SetParametersResult
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher

from biped_common.settings import AnySettings, SettingsError
from biped_ros.parameters import changed_settings, declared_settings
from biped_ros.process import process_name
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.topics import Topic
from msgs_json.wire import MalformedMessageError, RefusedMessageError

_DIAGNOSTICS_PERIOD_S = 1.0
_LOOK_PERIOD_S = 0.05
# Of all publishers together, since a subscriber may be dead or stopped.
_ACKNOWLEDGED_S = 1.0


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
        """Messages received, dropped, refused and malformed, by topic."""
        self.failure: str | None = None
        """Set by a node that cannot go on: why."""
        self._changed: Callable[[Any], None] | None = None
        self._present_settings: Any = None
        self._ros_parameters: frozenset[str] = frozenset()
        """Those that every node has, such as use_sim_time."""
        self._worst = DiagnosticStatus.OK
        self._remarks: dict[str, str] = {}
        self._rated: Counter[str] = Counter()
        self._rated_at = time.monotonic()
        self._diagnostics = self.publisher(topics.DIAGNOSTICS)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._publish_diagnostics)

    def close(self) -> None:
        """Let go of what is not ROS's; nodes override it."""

    def await_acknowledgements(self) -> None:
        """Publish the last diagnostics; wait a little until everything has arrived.

        A publisher that ends takes with it what it would have to send again: of a fast
        one, the last moments.
        """
        self._publish_diagnostics()
        end = time.monotonic() + _ACKNOWLEDGED_S
        for publisher in self.publishers:
            left_s = max(0.0, end - time.monotonic())
            publisher.wait_for_all_acked(Duration(seconds=left_s))

    # -- parameters ----------------------------------------------------------------

    def settings_from_parameters(
        self,
        cls: type[AnySettings],
        changed: Callable[[AnySettings], None] | None = None,
    ) -> AnySettings:
        """Declare the node's settings as its parameters; return them.

        Args:
            cls: settings dataclass.
            changed: gets the settings anew whenever a live one was changed.

        Raises:
            SettingsError: a parameter that was given cannot be used.
        """
        self._ros_parameters = frozenset(self.list_parameters([], 0).names)
        self._changed = changed
        settings = declared_settings(self, cls)
        self._present_settings = settings
        return settings

    def set_parameters_atomically(
        self, parameter_list: list[Parameter]
    ) -> SetParametersResult:
        """Change live settings, all of them or, where one cannot be changed, none."""
        if self._present_settings is None:
            return super().set_parameters_atomically(parameter_list)
        ours = [p for p in parameter_list if p.name not in self._ros_parameters]
        try:
            settings = changed_settings(self._present_settings, ours)
        except SettingsError as error:
            return SetParametersResult(successful=False, reason=str(error))
        result = super().set_parameters_atomically(parameter_list)
        if result.successful and ours:
            self._present_settings = settings
            if self._changed is not None:
                self._changed(settings)
        return result

    # -- messages ------------------------------------------------------------------

    def publisher(self, topic: Topic) -> Publisher:
        """Return a publisher of a topic of the graph."""
        return self.create_publisher(
            message_type(topic), topic.name, qos_profile(topic)
        )

    def listen(self, topic: Topic, handle: Callable[[bytes], None]) -> None:
        """Hand every message of a topic, as serialized bytes, to a guarded handler."""

        def received(message: bytes) -> None:
            self.counts[f"{topic.name} received"] += 1
            self.guarded(topic, handle, bytes(message))

        self.create_subscription(
            message_type(topic), topic.name, received, qos_profile(topic), raw=True
        )

    def listen_once_heard(
        self,
        topic: Topic,
        handle: Callable[[bytes], None],
        answers: Mapping[Publisher, str],
    ) -> None:
        """Listen to a topic as soon as the answers to it reach whom they are for.

        Middleware connects publishers and subscribers one by one: a node that answers
        before its answer is wanted speaks to nobody, and the first walk waits in vain.

        Args:
            topic: to listen to.
            handle: as for `listen`.
            answers: publishers of the answers, and the node that waits for each.
        """

        def look() -> None:
            if all(
                self.reaches(publisher, peer) for publisher, peer in answers.items()
            ):
                timer.cancel()
                self.listen(topic, handle)

        timer = self.create_timer(_LOOK_PERIOD_S, look)

    def reaches(self, publisher: Publisher, *peers: str) -> bool:
        """Return whether a publisher is connected to all its subscribers on the graph.

        Args:
            publisher: of this node.
            peers: nodes that must be among the subscribers.
        """
        subscribers = self.get_subscriptions_info_by_topic(publisher.topic_name)
        known = {info.node_name for info in subscribers}
        connected = int(publisher.get_subscription_count())
        return known.issuperset(peers) and connected >= len(subscribers)

    def guarded(
        self, topic: Topic, handle: Callable[[bytes], None], message: bytes
    ) -> None:
        """Handle a message, and count it where the handler will not have it."""
        try:
            handle(message)
        except RefusedMessageError as error:
            self.refuse(topic, "refused", error)
        except MalformedMessageError as error:
            self.refuse(topic, "malformed", error)

    def refuse(self, topic: Topic, kind: str, error: Exception) -> None:
        """Count a message that was not acted on."""
        self.counts[f"{topic.name} {kind}"] += 1
        self.remark(DiagnosticStatus.WARN, f"{topic.name} {kind}", str(error))
        self.get_logger().warning(
            f"{topic.name}: {kind}: {error}", throttle_duration_sec=1.0
        )

    def dropped(self, topic: Topic, messages: int) -> None:
        """Count messages that were sent but never came."""
        if messages > 0:
            self.counts[f"{topic.name} dropped"] += messages
            text = f"{topic.name}: {messages} messages never came"
            self.remark(DiagnosticStatus.WARN, f"{topic.name} dropped", text)
            self.get_logger().warning(text, throttle_duration_sec=1.0)

    # -- diagnostics ---------------------------------------------------------------

    def remark(self, level: bytes, key: str, text: str) -> None:
        """Put a remark into the next diagnostics, with its severity."""
        self._worst = max(self._worst, level)
        self._remarks[key] = text

    def figures(self) -> dict[str, str]:
        """Return what the node adds to its diagnostics; nodes override it."""
        return {}

    def _rates(self) -> dict[str, str]:
        """Return messages received per second since the last diagnostics, by topic."""
        now = time.monotonic()
        elapsed_s, self._rated_at = now - self._rated_at, now
        new = self.counts - self._rated
        self._rated = self.counts.copy()
        return {
            f"{key} [Hz]": f"{new[key] / elapsed_s:.1f}"
            for key in self.counts
            if key.endswith("received")
        }

    def _publish_diagnostics(self) -> None:
        status = DiagnosticStatus(
            level=self._worst,
            name=self.get_name(),
            hardware_id=process_name(),
            message="; ".join(self._remarks.values()) or "running",
        )
        counts = {key: str(number) for key, number in self.counts.items()}
        figures = {**counts, **self._rates(), **self.figures()}
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
