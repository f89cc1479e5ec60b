"""A node for the duration of one verb: join the graph, look around, spin, leave."""

from __future__ import annotations

import argparse
import math
import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.task import Future

from biped_common.signals import stop_requests
from ros2_verbs.errors import VerbError
from ros2_verbs.options import DISCOVERY_S

_Seen = TypeVar("_Seen")

# The rest of Fast DDS's announcement period of 3 s.
_PATIENCE_S = 2.5
# A graph that has not changed for so long is known: the parts of one node come within
# some milliseconds, and nodes within two of their announcements.
_QUIET_S = 0.25
_GLANCE_S = 1.0
# How often the graph is looked at, and how soon Ctrl-C is obeyed.
_POLL_S = 0.01
_TURN_S = 0.1


@contextmanager
def graph_node(args: argparse.Namespace, name: str | None = None) -> Iterator[Node]:
    """Join the graph; SIGINT and SIGTERM stay with Python.

    Args:
        args: with `use_sim_time`, if the verb has it.
        name: of the node; by default one that is hidden and nobody else's.

    Yields:
        The node. Nothing has been discovered yet: see `discover`.

    Raises:
        VerbError: something on the graph was to have a name that it cannot have.
    """
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = None
    try:
        sim_time = getattr(args, "use_sim_time", False)
        node = rclpy.create_node(
            name or f"_ros2cli_{os.getpid()}",
            enable_rosout=False,
            start_parameter_services=False,
            parameter_overrides=[Parameter("use_sim_time", value=sim_time)],
        )
        yield node
    except NameValidationException as error:
        # Its second and third line show where; the verb has one.
        raise VerbError(" ".join(str(error).splitlines()[:2])) from None
    finally:
        if node is not None:
            node.destroy_node()
        rclpy.try_shutdown()


def discover(
    args: argparse.Namespace, until: Callable[[], bool], *, at_once: bool = False
) -> bool:
    """Let the node get to know the graph.

    A node that misses the answer to its first announcement gets the next one only with
    the other's periodic announcement: after 0.1 s from the project's own nodes, but up
    to 3 s from others. So who has not found what it looks for looks longer, unless the
    user has said how long.

    Args:
        args: with `spin_time` [s], waited in any case, since not all comes at once.
        until: whether that is known without which the verb can do nothing.
        at_once: end as soon as that holds; nothing else is needed.

    Returns:
        Whether `until` holds.
    """
    is_default = args.spin_time == DISCOVERY_S
    longest_s = args.spin_time + (_PATIENCE_S if is_default else 0.0)
    began = time.monotonic()
    while True:
        holds = until()
        waited_s = time.monotonic() - began
        if waited_s >= longest_s:
            return holds
        if holds and (at_once or waited_s >= args.spin_time):
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


def whole_graph(args: argparse.Namespace, look: Callable[[Node], _Seen]) -> _Seen:
    """Return what a look at the graph finds, once it has settled."""
    with graph_node(args) as node:
        discover(args, settled(node))
        return look(node)


def glance(args: argparse.Namespace, look: Callable[[Node], _Seen]) -> _Seen:
    """Look at the graph for the shell: a TAB that takes longer seems to hang."""
    with graph_node(args) as node:
        wait_until(settled(node), _GLANCE_S)
        return look(node)


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
    timeout_s: float = math.inf,
    executor: Executor | None = None,
) -> bool:
    """Serve the node's callbacks until one of them sets the result of `finished`.

    Args:
        node: any; see `executor`.
        finished: its exception, if one is set, is raised here.
        timeout_s: how long at most.
        executor: by default the events executor, which costs a quarter of the others
            but knows no guard conditions and no callbacks of `(message, info)`.

    Returns:
        Whether it finished in time.
    """
    chosen = EventsExecutor() if executor is None else executor
    chosen.add_node(node)
    end = time.monotonic() + timeout_s
    # A signal ends a turn; within a callback rclpy would report it as a failure.
    with stop_requests() as stops:
        while not finished.done() and not stops:
            left_s = min(_TURN_S, end - time.monotonic())
            if left_s <= 0.0:
                break
            chosen.spin_until_future_complete(finished, timeout_sec=left_s)
    chosen.remove_node(node)
    if stops:
        signal.raise_signal(stops[0])
    if finished.done():
        finished.result()  # raises what a callback has found wrong
    return bool(finished.done())
