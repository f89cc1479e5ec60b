"""A node for the duration of one verb, and the options that go with it."""

from __future__ import annotations

import argparse
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import rclpy
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from biped_common.signals import stop_requests

HIDDEN_PREFIX = "_"
"""Nodes and topics whose names begin so are not listed unless asked for."""
DISCOVERY_S = 0.5

_NAME = "_ros2cli"
# The rest of Fast DDS's announcement period of 3 s.
_PATIENCE_S = 2.5
# A graph that has not changed for so long is known: the parts of one node come within
# some milliseconds, and nodes within two of their announcements.
_QUIET_S = 0.25
_GLANCE_S = 1.0
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
    args: argparse.Namespace,
    until: Callable[[], bool] | None = None,
    *,
    at_once: bool = False,
) -> bool:
    """Let the node get to know the graph.

    A node that misses the answer to its first announcement gets the next one only with
    the other's periodic announcement: after 0.1 s from the project's own nodes, but up
    to 3 s from others. So who has not found what it looks for looks longer, unless the
    user has said how long.

    Args:
        args: with `spin_time` [s], waited in any case, since not all comes at once.
        until: whether that is known without which the verb can do nothing.
        at_once: nothing else is needed; end as soon as `until` holds.

    Returns:
        Whether `until` holds.
    """
    spin_time_s = getattr(args, "spin_time", DISCOVERY_S)
    is_default = spin_time_s == DISCOVERY_S
    longest_s = spin_time_s + (_PATIENCE_S if until and is_default else 0.0)
    began = time.monotonic()
    while True:
        holds = until is not None and until()
        waited_s = time.monotonic() - began
        if waited_s >= longest_s:
            return holds
        if holds and (at_once or waited_s >= spin_time_s):
            return True
        time.sleep(_POLL_S)


def settled(node: Node) -> Callable[[], bool]:
    """Return a condition: others are known, and nothing new has come for a while.

    For lists, which cannot know what they have missed.
    """
    seen: object = None
    since = time.monotonic()

    def holds() -> bool:
        nonlocal seen, since
        known = (
            node.get_node_names_and_namespaces(),
            node.get_topic_names_and_types(),
            node.get_service_names_and_types(),
        )
        if known != seen:
            seen, since = known, time.monotonic()
        others = len(known[0]) > 1
        return others and time.monotonic() - since >= _QUIET_S

    return holds


def glance(node: Node) -> None:
    """Look at the graph for the shell: a TAB that takes longer seems to hang."""
    wait_until(settled(node), _GLANCE_S)


def wait_until(condition: Callable[[], bool], timeout_s: float) -> bool:
    """Wait without spinning (the graph needs none); return whether it came true."""
    end = time.monotonic() + timeout_s
    while not (holds := condition()) and time.monotonic() < end:
        time.sleep(_POLL_S)
    return holds


def caught(finished: Future, callback: Callable[..., None]) -> Callable[..., None]:
    """Return a callback whose errors end `spin`, without the executor's own report."""

    def call(*message: Any) -> None:
        if finished.done():
            return
        try:
            callback(*message)
        except Exception as error:
            finished.set_exception(error)

    return call


def spin(
    node: Node,
    finished: Future,
    timeout_s: float | None = None,
    executor: Executor | None = None,
) -> bool:
    """Serve the node's callbacks until one of them sets the result of `finished`.

    Args:
        node: any; see `executor`.
        finished: its exception, if one is set, is raised here.
        timeout_s: None waits for ever.
        executor: by default the events executor, which costs a quarter of the others
            but knows no guard conditions and no callbacks of `(message, info)`.

    Returns:
        Whether it finished in time.
    """
    chosen = EventsExecutor() if executor is None else executor
    chosen.add_node(node)
    end = None if timeout_s is None else time.monotonic() + timeout_s
    # A signal ends a turn; within a callback rclpy would report it as a failure.
    with stop_requests() as stops:
        while not finished.done() and not stops:
            left = _TURN_S if end is None else min(_TURN_S, end - time.monotonic())
            if left <= 0.0:
                break
            chosen.spin_until_future_complete(finished, timeout_sec=left)
    chosen.remove_node(node)
    if stops:
        signal.raise_signal(stops[0])
    if finished.done():
        finished.result()  # raises what a callback has found wrong
    return bool(finished.done())
