"""What the supervisor sees of the graph: who is there, how the learner does."""

from __future__ import annotations

import time
from collections import Counter, defaultdict

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

from biped_common.terminal_text import printable
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.wire import MalformedMessageError, decode

NAME = "supervisor"


class GraphWatch:
    """A node that only listens.

    Others may be on the graph under the same names. Of a node that is expected from a
    process, only what comes from there is believed.
    """

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
        self.end_causes: Counter[EndCause] = Counter()
        """How many walks ended by each cause."""
        self._expected: dict[str, str] = {}
        self.heard_at: dict[str, float] = {}
        """When each node's diagnostics last came, by name."""
        self.remarks: dict[str, str] = {}
        """What each node last said of itself."""
        self.figures: defaultdict[str, dict[str, dict[str, str]]] = defaultdict(dict)
        """What each node last measured, by name and process."""
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
        """Return whether a node is on the graph and has spoken since `expect`."""
        return name in self._node.get_node_names() and name in self.heard_at

    def expect(self, name: str, process: str) -> None:
        """Expect a node, started now, from a process; forget that it was heard."""
        self._expected[name] = process
        self.heard_at.pop(name, None)

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _on_status(self, message: String) -> None:
        try:
            status = decode(LearnerStatus, message.data)
        except MalformedMessageError as error:
            self._node.get_logger().warning(printable(str(error)))
        else:
            if status.instance.endswith(self._expected.get(topics.LEARNER_NODE, "")):
                self.status = status

    def _on_episode(self, message: String) -> None:
        try:
            result = decode(EpisodeResult, message.data)
        except MalformedMessageError as error:
            self._node.get_logger().warning(printable(str(error)))
        else:
            # Before the learner takes part, another one may have ended this walk.
            if self.status is not None and self.status.active:
                self.result = result
                self.results += 1
                self.end_causes[result.end_cause] += 1

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            process = self._expected.get(status.name, status.hardware_id)
            if status.hardware_id == process:
                self.heard_at[status.name] = time.monotonic()
                self.remarks[status.name] = status.message
                self.figures[status.name][process] = {
                    figure.key: figure.value for figure in status.values
                }
