"""What the supervisor sees of the graph: who is there, how the learner does."""

from __future__ import annotations

import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.ros.qos import qos_profile
from msgs_json.wire import MalformedMessageError, decode

NAME = "supervisor"


class GraphWatch:
    """A node that only listens."""

    def __init__(self, domain: int) -> None:
        """Join the domain."""
        self._context = rclpy.Context()
        rclpy.init(
            context=self._context,
            domain_id=domain,
            signal_handler_options=rclpy.signals.SignalHandlerOptions.NO,
        )
        self._node = rclpy.create_node(NAME, context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self.status: LearnerStatus | None = None
        self.result: EpisodeResult | None = None
        self.results = 0
        self.heard_at: dict[str, float] = {}
        """When each node's diagnostics last came, by name."""
        self.remarks: dict[str, str] = {}
        """What each node last said of itself."""
        for topic, kind, handle in (
            (topics.LEARNER_STATUS, String, self._on_status),
            (topics.EPISODE, String, self._on_episode),
            (topics.DIAGNOSTICS, DiagnosticArray, self._on_diagnostics),
        ):
            self._node.create_subscription(kind, topic.name, handle, qos_profile(topic))

    def spin(self, duration_s: float) -> None:
        """Take in what comes during this time."""
        end = time.monotonic() + duration_s
        while (left := end - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def has_node(self, name: str) -> bool:
        """Return whether a node is on the graph and has spoken since `forget`."""
        return name in self._node.get_node_names() and name in self.heard_at

    def forget(self, name: str) -> None:
        """Forget that a node was heard, before it is started anew."""
        self.heard_at.pop(name, None)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _on_status(self, message: String) -> None:
        try:
            self.status = decode(LearnerStatus, message.data)
        except MalformedMessageError as error:
            self._node.get_logger().warning(str(error))

    def _on_episode(self, message: String) -> None:
        try:
            self.result = decode(EpisodeResult, message.data)
        except MalformedMessageError as error:
            self._node.get_logger().warning(str(error))
        else:
            self.results += 1

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.heard_at[status.name] = time.monotonic()
            self.remarks[status.name] = status.message
