"""What the verbs share that measure a topic: options, subscription, statistics."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node
from rclpy.task import Future

from biped_common.timing import NS_PER_S
from ros2_verbs.graph.endpoints import TOPICS, class_of_topic, topic_types
from ros2_verbs.graph.qos import listening_profile
from ros2_verbs.graph.session import caught, discover, graph_node, spin
from ros2_verbs.options import add_node_arguments

_REPORT_S = 1.0


def add_measuring_arguments(
    parser: argparse.ArgumentParser, window: int, number: Callable[[str], int]
) -> None:
    """Add the topic, its window and the options of every node.

    Args:
        parser: of the verb.
        window: messages to average over, unless told.
        number: reads the window's size.
    """
    TOPICS.add_name_argument(parser)
    parser.add_argument(
        "-w",
        "--window",
        type=number,
        default=window,
        help=f"number of messages to average over (default: {window})",
    )
    add_node_arguments(parser)


@contextmanager
def measured_topic(args: argparse.Namespace) -> Iterator[tuple[Node, Any]]:
    """Wait for a verb's topic to appear; give a node and the message class."""
    with graph_node(args) as node:
        topic = args.topic_name
        discover(args, lambda: bool(topic_types(node, topic)))
        yield node, class_of_topic(node, topic, math.inf, verb="measure")


def measure(
    args: argparse.Namespace,
    node: Node,
    kind: Any,
    take: Callable[[Any], None],
    *,
    raw: bool,
    report: Callable[[], str | None] | None = None,
) -> None:
    """Hand every message to `take`, and print reports, until interrupted.

    Args:
        args: of the verb, with the topic.
        node: that listens.
        kind: of the messages.
        take: gets each message.
        raw: as serialized bytes.
        report: asked once a second; None where there is nothing to print.
    """
    finished: Future = Future()
    node.create_subscription(
        kind,
        args.topic_name,
        caught(finished, take),
        listening_profile(node, args.topic_name, args),
        raw=raw,
    )
    if report is not None:

        def print_report() -> None:
            if (text := report()) is not None:
                print(text)

        node.create_timer(_REPORT_S, caught(finished, print_report))
    spin(node, finished)


def spread_text(durations_ns: Collection[int]) -> str:
    """Return the second line of what `hz` and `delay` print.

    Args:
        durations_ns: at least one; the deviation is the population's.
    """
    seconds = [duration_ns / NS_PER_S for duration_ns in durations_ns]
    mean = sum(seconds) / len(seconds)
    variance = sum((value - mean) ** 2 for value in seconds) / len(seconds)
    return (
        f"\tmin: {min(seconds):.3f}s max: {max(seconds):.3f}s "
        f"std dev: {math.sqrt(variance):.5f}s window: {len(seconds)}"
    )
