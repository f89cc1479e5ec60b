"""What the supervisor sees of the graph: who is there, how the learner does."""

from __future__ import annotations

import time
from collections import Counter, defaultdict, deque
from collections.abc import Callable

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental import EventsExecutor
from rclpy.task import Future

from biped_common.terminal_text import printable
from biped_ros.cdr import string_text
from biped_ros.environment import LEASE_S
from biped_ros.qos import qos_profile
from biped_ros.sole_publisher import Publishers, SolePublisherListener
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation
from msgs_json.topics import Topic
from msgs_json.wire import MalformedMessageError, decode

NAME = "supervisor"
FOXGLOVE = "foxglove_bridge"
TF_NODE = "tf_node"
_NODES = (
    topics.SIM_NODE,
    topics.TRAJECTORY_NODE,
    topics.LEARNER_NODE,
    topics.RECORDER_NODE,
    FOXGLOVE,
    TF_NODE,
)
# A result and the observation that bears it out come by different ways.
_REMEMBERED_OBSERVATIONS = 100
_BORNE_OUT_WITHIN_S = 5.0
_SPIN_LOOK_S = 0.01
# For this long a node that was started anew meets its predecessor on the graph.
_PREDECESSOR_S = 2.0 * LEASE_S


class GraphWatch:
    """A node that only listens.

    Others may be on the graph under the same names. Of a node that is expected from a
    process, only what comes from there is believed, and of control topics only what
    their owners say while nobody else publishes there. A walk has ended as its result
    says where the robot's own observations agree.
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
        self._executor = EventsExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._over = Future()
        self._spin_end = 0.0
        self._node.create_timer(_SPIN_LOOK_S, self._end_spin)
        self._publishers = Publishers(self._node)
        self._joined_at = time.monotonic()
        self.status: LearnerStatus | None = None
        self.result: EpisodeResult | None = None
        """Of the last walk that ended."""
        self.results = 0
        self.end_causes: Counter[EndCause] = Counter()
        """How many walks ended by each cause."""
        self._claimed: EpisodeResult | None = None
        self._claimed_at = 0.0
        self._observations: deque[bytes] = deque(maxlen=_REMEMBERED_OBSERVATIONS)
        self._expected: dict[str, str] = {}
        self._expected_at: dict[str, float] = {}
        self.heard_at: dict[str, float] = {}
        """When each node's diagnostics last came, by name."""
        self.remarks: dict[str, str] = {}
        """What each node last said of itself."""
        self.figures: defaultdict[str, dict[str, dict[str, str]]] = defaultdict(dict)
        """What each node last measured, by name and process started here."""
        self.strangers: dict[str, str] = {}
        """Who has ever published beside a control topic's owner, last, by topic."""
        self._listeners: list[SolePublisherListener] = []
        for topic, handle in (
            (topics.LEARNER_STATUS, self._on_status),
            (topics.EPISODE, self._on_episode),
            (topics.OBSERVATION, self._on_observation),
        ):
            self._listeners.append(
                SolePublisherListener(
                    self._node, topic, self._guarded(topic, handle), self._on_stranger
                )
            )
        self._node.create_subscription(
            DiagnosticArray,
            topics.DIAGNOSTICS.name,
            self._on_diagnostics,
            qos_profile(topics.DIAGNOSTICS),
        )

    def spin(self, duration_s: float) -> None:
        """Take in what comes during this time."""
        self._over = Future()
        self._spin_end = time.monotonic() + duration_s
        self._executor.spin_until_future_complete(self._over, duration_s)

    def _end_spin(self) -> None:
        # The executor looks at its own time-out only when no message waits.
        if time.monotonic() >= self._spin_end and not self._over.done():
            self._over.set_result(None)

    def has_node(self, name: str) -> bool:
        """Return whether a node is on the graph and has spoken since `expect`."""
        return name in self._node.get_node_names() and name in self.heard_at

    def expect(self, name: str, process: str) -> None:
        """Expect a node, started now, from a process; forget that it was heard."""
        self._expected[name] = process
        self._expected_at[name] = time.monotonic()
        self.heard_at.pop(name, None)

    def taken(self, name: str) -> str | None:
        """Name who publishes what a node is to publish; None where nobody does."""
        for topic in topics.CONTROL:
            if topic.owner == name and (other := self._publishers.any_on(topic)):
                return f"{topic.name} is published already by {other}"
        return None

    @property
    def watched_s(self) -> float:
        """How long the graph has been looked at [s]."""
        return time.monotonic() - self._joined_at

    @property
    def unseen(self) -> EpisodeResult | None:
        """A result that the robot's observations have not borne out in time."""
        waited_s = time.monotonic() - self._claimed_at
        return self._claimed if waited_s > _BORNE_OUT_WITHIN_S else None

    def close(self) -> None:
        """Leave the domain."""
        self._executor.shutdown()
        for listener in self._listeners:
            listener.close()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _guarded(
        self, topic: Topic, handle: Callable[[bytes], None]
    ) -> Callable[[bytes], None]:
        def guarded(message: bytes) -> None:
            try:
                handle(message)
            except MalformedMessageError as error:
                self._node.get_logger().warning(
                    printable(f"{topic.name}: {error}"), throttle_duration_sec=1.0
                )

        return guarded

    def _on_status(self, message: bytes) -> None:
        status = decode(LearnerStatus, string_text(message))
        if status.instance.endswith(self._expected.get(topics.LEARNER_NODE, "")):
            self.status = status

    def _on_episode(self, message: bytes) -> None:
        self._claimed = decode(EpisodeResult, string_text(message))
        self._claimed_at = time.monotonic()
        for observed in reversed(self._observations):
            self._compare(observed)

    def _on_observation(self, message: bytes) -> None:
        self._observations.append(message)
        if self._claimed is not None:
            self._compare(message)

    def _compare(self, message: bytes) -> None:
        """Believe the claimed result, if this is the walk's last observation."""
        claimed = self._claimed
        if claimed is None:
            return
        last = decode(Observation, string_text(message))
        if (last.episode, last.control_tick, last.trajectory_sha256) == (
            claimed.episode,
            claimed.control_ticks,
            claimed.trajectory_sha256,
        ):
            self._claimed = None
            self.result = claimed
            self.results += 1
            self.end_causes[claimed.end_cause] += 1

    def _on_stranger(self, topic: Topic, text: str | None) -> None:
        assert topic.owner is not None
        started_at = self._expected_at.get(topic.owner, -_PREDECESSOR_S)
        anew = time.monotonic() - started_at < _PREDECESSOR_S
        if text is not None and not (anew and self._publishers.namesakes(topic)):
            self.strangers[topic.name] = text

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            process = self._expected.get(status.name, status.hardware_id)
            if status.name in _NODES and status.hardware_id == process:
                self.heard_at[status.name] = time.monotonic()
                self.remarks[status.name] = status.message
                own = self._expected.get(status.name, "")
                self.figures[status.name][own] = {
                    figure.key: figure.value for figure in status.values
                }
