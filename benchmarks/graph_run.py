"""The three nodes as processes, and a listener beside them, for the benchmarks."""

from __future__ import annotations

import struct
import tempfile
import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.experimental import EventsExecutor
from rclpy.task import Future
from std_msgs.msg import String

from biped_bringup.supervisor.supervisor import Supervisor
from biped_common.timing import CONTROL_PERIOD_US
from biped_ros.environment import node_environment, private_domain
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import decode

# A serialized message with a header begins with its stamp.
_CDR_HEADER_BYTES = 4
_STAMP = struct.Struct("<iI")
_TURN_S = 0.2


class Listener:
    """Counts joint states and keeps the robot's last diagnostics, in a thread."""

    def __init__(self, domain: int) -> None:
        """Join the domain and listen."""
        self.arrivals_ns: list[int] = []
        """When each message of /joint_states came."""
        self.control_ticks: list[int] = []
        """Of the simulation's clock, of each of these messages."""
        self.results: list[EpisodeResult] = []
        """Of the walks, as the learner tells them."""
        self.figures: dict[str, str] = {}
        """What sim_node last said in /diagnostics."""
        self._context = rclpy.Context()
        rclpy.init(
            context=self._context,
            domain_id=domain,
            signal_handler_options=rclpy.signals.SignalHandlerOptions.NO,
        )
        self._node = rclpy.create_node("listener", context=self._context)
        for topic, handle, raw in (
            (topics.JOINT_STATES, self._on_joint_states, True),
            (topics.EPISODE, self._on_episode, False),
            (topics.DIAGNOSTICS, self._on_diagnostics, False),
        ):
            self._node.create_subscription(
                message_type(topic), topic.name, handle, qos_profile(topic), raw=raw
            )
        self._stopping = threading.Event()
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def close(self) -> None:
        """Leave the domain."""
        self._stopping.set()
        self._thread.join()
        self._node.destroy_node()
        rclpy.try_shutdown(context=self._context)

    def _spin(self) -> None:
        executor = EventsExecutor(context=self._context)
        executor.add_node(self._node)
        never: Future = Future()
        while not self._stopping.is_set():
            executor.spin_until_future_complete(never, timeout_sec=_TURN_S)

    def _on_joint_states(self, message: bytes) -> None:
        self.arrivals_ns.append(time.monotonic_ns())
        seconds, nanoseconds = _STAMP.unpack_from(message, _CDR_HEADER_BYTES)
        microseconds = seconds * 1_000_000 + nanoseconds // 1000
        self.control_ticks.append(microseconds // CONTROL_PERIOD_US)

    def _on_episode(self, message: String) -> None:
        self.results.append(decode(EpisodeResult, message.data))

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "sim_node":
                self.figures = {pair.key: pair.value for pair in status.values}


def run_graph(
    parameters: Mapping[str, Mapping[str, Any]],
    done: Callable[[Supervisor, Listener], bool],
    timeout_s: float = 300.0,
) -> Listener:
    """Start the nodes, wait until `done`, end them, and return what was heard.

    Raises:
        TimeoutError: it takes too long.
    """
    domain = private_domain()
    end = time.monotonic() + timeout_s
    with tempfile.TemporaryDirectory() as folder:
        listener = Listener(domain)
        supervisor = Supervisor(
            parameters,
            node_environment(domain, "LOCALHOST"),
            Path(folder),
            lambda who, line: None,
        )
        try:
            supervisor.run(
                lambda: done(supervisor, listener), lambda: time.monotonic() > end
            )
        finally:
            supervisor.stop()
            listener.close()
    if time.monotonic() > end:
        raise TimeoutError(f"the nodes were not done within {timeout_s:g} s")
    return listener
