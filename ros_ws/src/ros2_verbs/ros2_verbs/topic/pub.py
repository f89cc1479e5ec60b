"""Publish a message to a topic."""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.task import Future

from ros2_verbs import completion
from ros2_verbs.arguments import positive_float, unsigned_int
from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import (
    add_node_arguments,
    caught,
    graph_node,
    spin,
)
from ros2_verbs.message_fill import Stamp, fill, values_of
from ros2_verbs.message_types import message_class
from ros2_verbs.qos_options import add_qos_arguments, profile_of

_KEEP_ALIVE_S = 0.1
_WAIT_POLL_S = 0.1
_WAIT_REPORT_S = 1.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    completion.completed(
        parser.add_argument("topic_name", help="topic, e.g. /chatter"),
        completion.topic_names,
    )
    completion.completed(
        parser.add_argument("message_type", help="type, e.g. std_msgs/msg/String"),
        completion.message_names,
    )
    values = parser.add_mutually_exclusive_group()
    completion.completed(
        values.add_argument(
            "values",
            nargs="?",
            default="{}",
            help="what to fill the message with, in YAML, e.g. 'data: Hello'; the rest "
            "keeps its defaults; a header may be 'auto' and a time 'now'",
        ),
        completion.message_prototype,
    )
    values.add_argument(
        "--stdin", action="store_true", help="read the values from standard input"
    )
    parser.add_argument(
        "-r",
        "--rate",
        metavar="N",
        type=positive_float,
        default=1.0,
        help="publishing rate in Hz (default: 1)",
    )
    parser.add_argument(
        "-p",
        "--print",
        metavar="N",
        type=int,
        default=1,
        help="only print every N-th published message (default: 1)",
    )
    number = parser.add_mutually_exclusive_group()
    number.add_argument(
        "-1", "--once", action="store_true", help="publish one message and exit"
    )
    number.add_argument(
        "-t",
        "--times",
        type=unsigned_int,
        default=0,
        metavar="N",
        help="publish this number of times and exit",
    )
    parser.add_argument(
        "-w",
        "--wait-matching-subscriptions",
        type=unsigned_int,
        metavar="N",
        help="wait for so many subscriptions (default: 1 with --once or --times, "
        "otherwise 0)",
    )
    parser.add_argument(
        "--max-wait-time-secs",
        type=positive_float,
        metavar="SECONDS",
        help="the longest wait for subscriptions (default: endless)",
    )
    parser.add_argument(
        "--keep-alive",
        metavar="SECONDS",
        type=positive_float,
        default=_KEEP_ALIVE_S,
        help="stay so long after the last message (default: 0.1)",
    )
    parser.add_argument("-n", "--node-name", help="name of the publishing node")
    add_qos_arguments(parser, "publish", "default")
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Publish until interrupted, or as often as the options say."""
    message = message_class(args.message_type)()
    stamps = fill(message, values_of(sys.stdin.read() if args.stdin else args.values))
    times = 1 if args.once else args.times
    with graph_node(args, args.node_name) as node:
        publisher = node.create_publisher(
            type(message), args.topic_name, profile_of(args)
        )
        _await_subscriptions(publisher, args, default=1 if times else 0)
        print("publisher: beginning loop")
        loop = _PublishingLoop(node, publisher, message, stamps, args.print, times)
        loop.publish()
        node.create_timer(1.0 / args.rate, caught(loop.finished, loop.publish))
        spin(node, loop.finished)
        time.sleep(args.keep_alive)
    return 0


def _await_subscriptions(
    publisher: Publisher, args: argparse.Namespace, default: int
) -> None:
    asked = args.wait_matching_subscriptions
    wanted = default if asked is None else asked
    began = time.monotonic()
    reported = -_WAIT_REPORT_S
    while (found := publisher.get_subscription_count()) < wanted:
        waited_s = time.monotonic() - began
        if args.max_wait_time_secs is not None and waited_s >= args.max_wait_time_secs:
            raise VerbError(
                f"Timed out waiting for subscribers: Expected {wanted} subscribers but "
                f"only got {found} subscribers"
            )
        if waited_s >= reported + _WAIT_REPORT_S:
            print(f"Waiting for at least {wanted} matching subscription(s)...")
            reported = waited_s
        time.sleep(_WAIT_POLL_S)


class _PublishingLoop:
    """Publishes a message again and again."""

    def __init__(
        self,
        node: Node,
        publisher: Publisher,
        message: Any,
        stamps: list[Stamp],
        print_every: int,
        times: int,
    ) -> None:
        """Begin.

        Args:
            node: whose clock stamps the messages.
            publisher: of the topic.
            message: what is published.
            stamps: set its times anew.
            print_every: print each so many messages; 0 prints none.
            times: how often to publish; 0 for ever.
        """
        self.finished: Future = Future()
        self._clock = node.get_clock()
        self._publisher = publisher
        self._message = message
        self._stamps = stamps
        self._print_every = print_every
        self._times = times
        self._count = 0

    def publish(self) -> None:
        """Publish once more."""
        self._count += 1
        now = self._clock.now().to_msg()
        for stamp in self._stamps:
            stamp(now)
        if self._print_every and self._count % self._print_every == 0:
            print(f"publishing #{self._count}: {self._message!r}\n")
        self._publisher.publish(self._message)
        if self._count == self._times:
            self.finished.set_result(None)
