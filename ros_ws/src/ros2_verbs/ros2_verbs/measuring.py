"""What the verbs that measure a topic share: its options, its subscription, its end."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node
from rclpy.task import Future

from ros2_verbs import completion
from ros2_verbs.graph_node import (
    add_node_arguments,
    caught,
    discover,
    graph_node,
    spin,
)
from ros2_verbs.qos_options import listening_profile
from ros2_verbs.topics import class_of_topic, is_known

REPORT_S = 1.0


def add_measuring_arguments(
    parser: argparse.ArgumentParser, window: int, number: Callable[[str], int]
) -> None:
    """Add the topic, its window and the options of every node.

    Args:
        parser: of the verb.
        window: messages to average over, unless told.
        number: reads the window's size.
    """
    completion.completed(
        parser.add_argument("topic_name", help="topic, e.g. /joint_states"),
        completion.topic_names,
    )
    parser.add_argument(
        "-w",
        "--window",
        type=number,
        default=window,
        help=f"number of messages to average over (default: {window})",
    )
    add_node_arguments(parser)


class MeasuredTopic:
    """A topic that is being listened to until interrupted."""

    def __init__(self, node: Node, args: argparse.Namespace) -> None:
        """Wait for the topic to appear."""
        discover(args, until=lambda: is_known(node, args.topic_name))
        self.node = node
        self.kind = class_of_topic(
            node, args.topic_name, timeout_s=None, verb="measure"
        )
        self._args = args
        self._finished: Future = Future()

    def measure(
        self,
        take: Callable[[Any], None],
        raw: bool,
        report: Callable[[], str | None] | None = None,
    ) -> None:
        """Hand every message to `take`, and print reports, until interrupted.

        Args:
            take: gets each message.
            raw: as serialized bytes.
            report: asked once a second; None where there is nothing to print.
        """
        self.node.create_subscription(
            self.kind,
            self._args.topic_name,
            caught(self._finished, take),
            listening_profile(self.node, self._args.topic_name, self._args),
            raw=raw,
        )
        if report is not None:
            self._print_each_second(report)
        spin(self.node, self._finished)

    def _print_each_second(self, report: Callable[[], str | None]) -> None:
        def print_report() -> None:
            text = report()
            if text is not None:
                print(text)

        self.node.create_timer(REPORT_S, caught(self._finished, print_report))


@contextmanager
def measured_topic(args: argparse.Namespace) -> Iterator[MeasuredTopic]:
    """Give the topic of a verb's arguments, once it is there."""
    with graph_node(args) as node:
        yield MeasuredTopic(node, args)
