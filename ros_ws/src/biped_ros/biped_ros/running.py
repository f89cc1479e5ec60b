"""Run a node as a process, from its start to an orderly end."""

from __future__ import annotations

import signal
import sys
from collections.abc import Callable
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.executors import ExternalShutdownException
from rclpy.experimental import EventsExecutor
from rclpy.task import Future

from biped_common.command_line import WRONG_INPUT
from biped_common.errors import BipedError
from biped_ros.environment import NoSecurityError, refuse_security
from biped_ros.guarded import GuardedNode
from biped_ros.process import bound_memory
from biped_ros.processor import ProcessorSettings, claim

REFUSED = 4
# The events executor cannot be interrupted in an endless spin, so it spins in turns.
_TURN_S = 0.2


def claim_processor(node: GuardedNode, settings: ProcessorSettings) -> None:
    """Ask for priority, cores and memory; what is refused, the node says once."""
    for text in claim(settings):
        node.get_logger().warning(text)
        node.remark(DiagnosticStatus.WARN, text, text)


def run_node(make: Callable[[], GuardedNode]) -> int:
    """Make a node, spin it until SIGINT or SIGTERM, and close it.

    Returns:
        The exit status: 0 after an orderly end, 2 for wrong input, 4 when the node gave
        up.
    """
    bound_memory()
    # Signals end the loop below, not the middle of a callback.
    try:
        refuse_security()
        rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    except NoSecurityError as error:
        print(f"cannot start: {error}", file=sys.stderr)
        return WRONG_INPUT
    except RuntimeError as error:
        # A parameter file that is not there or is no YAML, or a word out of place.
        print(f"wrong arguments: {' '.join(str(error).split())}", file=sys.stderr)
        return WRONG_INPUT
    stops: list[int] = []

    def stop(number: int, _: Any) -> None:
        stops.append(number)

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    try:
        node = make()
    except BipedError as error:
        rclpy.try_shutdown()
        print(f"cannot start: {error}", file=sys.stderr)
        return WRONG_INPUT
    try:
        executor = EventsExecutor()
        executor.add_node(node)
        never: Future = Future()
        while not stops and node.failure is None:
            executor.spin_until_future_complete(never, timeout_sec=_TURN_S)
        if node.failure is not None:
            print(f"{node.get_name()} gives up: {node.failure}", file=sys.stderr)
            return REFUSED
        return 0
    except ExternalShutdownException:
        return 0
    finally:
        node.close()
        node.await_acknowledgements()
        node.destroy_node()
        rclpy.try_shutdown()
