"""A node for the duration of one verb, and the options that go with it."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

HIDDEN_PREFIX = "_"
"""Nodes and topics whose names begin so are not listed unless asked for."""
DISCOVERY_S = 0.5

_NAME = "_ros2cli"
# How often the graph is looked at, and how soon Ctrl-C is obeyed.
_POLL_S = 0.01
_TURN_S = 0.1


def add_graph_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --spin-time, --use-sim-time and --no-daemon."""
    parser.add_argument(
        "--no-daemon",
        action="store_true",
        help="accepted for compatibility: there is no daemon here",
    )
    add_node_arguments(parser)


def add_node_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --spin-time and --use-sim-time."""
    parser.add_argument(
        "--spin-time",
        type=float,
        default=DISCOVERY_S,
        metavar="SECONDS",
        help=f"time to wait for discovery (default: {DISCOVERY_S} s)",
    )
    parser.add_argument(
        "-s", "--use-sim-time", action="store_true", help="take time from /clock"
    )


@contextmanager
def graph_node(args: argparse.Namespace, name: str | None = None) -> Iterator[Node]:
    """Join the graph; SIGINT and SIGTERM stay with Python.

    Args:
        args: with `use_sim_time`, if the verb has it.
        name: of the node; by default one that is hidden and nobody else's.

    Yields:
        The node. Nothing has been discovered yet: see `discover`.
    """
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = None
    try:
        sim_time = getattr(args, "use_sim_time", False)
        node = rclpy.create_node(
            name or f"{_NAME}_{os.getpid()}",
            enable_rosout=False,
            start_parameter_services=False,
            parameter_overrides=[Parameter("use_sim_time", value=sim_time)],
        )
        yield node
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def discover(
    args: argparse.Namespace, until: Callable[[], bool] = lambda: False
) -> bool:
    """Let the node get to know the graph.

    Args:
        args: with `spin_time` [s], the longest wait.
        until: ends the wait early; whatever a verb needs to know of the graph.

    Returns:
        Whether `until` holds.
    """
    return wait_until(until, getattr(args, "spin_time", DISCOVERY_S))


def wait_until(condition: Callable[[], bool], timeout_s: float) -> bool:
    """Wait without spinning (the graph needs none); return whether it came true."""
    end = time.monotonic() + timeout_s
    while not (holds := condition()) and time.monotonic() < end:
        time.sleep(_POLL_S)
    return holds


def spin(node: Node, finished: Future, timeout_s: float | None = None) -> bool:
    """Serve the node's callbacks until one of them sets the result of `finished`.

    Args:
        node: no guard conditions or Python waitables, and no callbacks that take
            `(message, info)`: the executor knows none, but costs little.
        finished: its exception, if one is set, is raised here.
        timeout_s: None waits for ever.

    Returns:
        Whether it finished in time.
    """
    executor = EventsExecutor()
    executor.add_node(node)
    end = None if timeout_s is None else time.monotonic() + timeout_s
    try:
        while not finished.done():
            left = _TURN_S if end is None else min(_TURN_S, end - time.monotonic())
            if left <= 0.0:
                return False
            executor.spin_until_future_complete(finished, timeout_sec=left)
    finally:
        executor.remove_node(node)
    finished.result()  # raises what a callback has found wrong
    return True
