"""A node that refuses bad messages, counts them and says so in /diagnostics.

What a handler cannot understand or must not act on never reaches robot or memory: the
handler raises, the message is counted under its topic, and the first of its kind and
then one a second is logged. Who publishes what only another node may is named, and not
heard. A change of parameters that is refused says which and why. A request that is too
large for any of its services is not answered in earnest.
"""

from __future__ import annotations

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
from rclpy.service import Service

from biped_common.settings import AnySettings, SettingsError
from biped_common.terminal_text import printable
from biped_ros.messages import message_type
from biped_ros.parameters import changed_settings, declared_settings
from biped_ros.process import process_name
from biped_ros.qos import qos_profile
from biped_ros.requests import REQUEST_LIMIT_BYTES, is_too_large
from biped_ros.sole_publisher import SolePublisherListener
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
        self._listeners: list[SolePublisherListener] = []
        self._strangers: dict[str, str] = {}
        """Who publishes beside the owner, by control topic."""
        self._rated: Counter[str] = Counter()
        self._rated_at = time.monotonic()
        self._diagnostics = self.publisher(topics.DIAGNOSTICS)
        self.create_timer(_DIAGNOSTICS_PERIOD_S, self._publish_diagnostics)

    def close(self) -> None:
        """Let go of what is not ROS's; nodes override it."""

    def destroy_node(self) -> None:
        """Leave the graph."""
        for listener in self._listeners:
            listener.close()
        super().destroy_node()

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

    # -- services ------------------------------------------------------------------

    def create_service(
        self,
        srv_type: Any,
        srv_name: str,
        callback: Callable[[Any, Any], Any],
        **options: Any,
    ) -> Service:
        """Offer a service whose requests are bounded; rclpy's own come here, too.

        To a request that is too large the answer is an empty one.
        """

        def bounded(request: Any, response: Any) -> Any:
            if not is_too_large(request):
                return callback(request, response)
            error = RefusedMessageError(
                f"a request of more than {REQUEST_LIMIT_BYTES} bytes"
            )
            self._refuse(srv_name, "refused", error)
            return response

        return super().create_service(srv_type, srv_name, bounded, **options)

    # -- messages ------------------------------------------------------------------

    def publisher(self, topic: Topic) -> Publisher:
        """Return a publisher of a topic of the graph."""
        return self.create_publisher(
            message_type(topic), topic.name, qos_profile(topic)
        )

    def listen(
        self,
        topic: Topic,
        handle: Callable[[bytes], None],
        answers: Mapping[Publisher, str] | None = None,
        anew: Callable[[], None] = lambda: None,
    ) -> None:
        """Hand every message of a topic, as serialized bytes, to a guarded handler.

        Of a control topic, only messages of its owner, while nobody else publishes on
        it.

        Args:
            topic: to listen to.
            handle: may refuse a message.
            answers: to a control topic, publishers of the answers, and the node that
                waits for each. Middleware connects publishers and subscribers one by
                one: a node that answers before its answer is wanted speaks to nobody,
                and the walk waits in vain. So messages come once answers get through.
            anew: told before messages of a control topic come, again and again: what
                was heard before need not be so.
        """

        def received(message: bytes) -> None:
            self.counts[f"{topic.name} received"] += 1
            self.guarded(topic, handle, bytes(message))

        def ready() -> bool:
            return all(self.reaches(who, peer) for who, peer in (answers or {}).items())

        if topic.owner is None:
            self.create_subscription(
                message_type(topic), topic.name, received, qos_profile(topic), raw=True
            )
        else:
            self._listeners.append(
                SolePublisherListener(self, topic, received, self.stranger, ready, anew)
            )

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
        self._refuse(topic.name, kind, error)

    def _refuse(self, name: str, kind: str, error: Exception) -> None:
        self.counts[f"{name} {kind}"] += 1
        text = printable(f"{name}: {kind}: {error}")
        self.remark(DiagnosticStatus.WARN, f"{name} {kind}", text)
        self.get_logger().warning(text, throttle_duration_sec=1.0)

    def stranger(self, topic: Topic, text: str | None) -> None:
        """Take note of who publishes on a control topic beside its owner.

        Args:
            topic: with an owner.
            text: names them; None where there is nobody, or nobody any more.
        """
        if text is not None:
            self.remark(DiagnosticStatus.ERROR, f"{topic.name} stranger", text)
        if text == self._strangers.get(topic.name):
            return
        if text is None:
            del self._strangers[topic.name]
            self.get_logger().info(f"{topic.name}: nobody publishes beside its owner")
        else:
            self._strangers[topic.name] = text
            self.get_logger().error(text, throttle_duration_sec=0.2)

    def dropped(self, topic: Topic, messages: int) -> None:
        """Count messages that were sent but never came."""
        if messages > 0:
            self.counts[f"{topic.name} dropped"] += messages
            text = f"{topic.name}: {messages} messages never came"
            self.remark(DiagnosticStatus.WARN, f"{topic.name} dropped", text)
            self.get_logger().warning(text, throttle_duration_sec=1.0)

    def warn(self, text: str) -> None:
        """Log a warning, and put it into the next diagnostics."""
        self.get_logger().warning(printable(text))
        self.remark(DiagnosticStatus.WARN, text, text)

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
