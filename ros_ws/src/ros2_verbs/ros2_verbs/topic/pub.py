"""Publish a message to a topic."""

from __future__ import annotations

import argparse
import math
import time
from typing import Any

from rclpy.publisher import Publisher
from rclpy.task import Future

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import TOPICS
from ros2_verbs.graph.qos import add_qos_arguments, profile_of
from ros2_verbs.graph.session import caught, graph_node, spin
from ros2_verbs.messages.fill import add_values_arguments, fill, given_values
from ros2_verbs.messages.text import to_yaml
from ros2_verbs.messages.types import complete_message_types, interface_class
from ros2_verbs.options import (
    add_node_arguments,
    completed,
    positive_float,
    unsigned_int,
)

_KEEP_ALIVE_S = 0.1
_WAIT_POLL_S = 0.1
_WAIT_REPORT_S = 1.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    TOPICS.add_name_argument(parser)
    completed(
        parser.add_argument("message_type", help="type, e.g. std_msgs/msg/String"),
        complete_message_types,
    )
    add_values_arguments(
        parser,
        "what to fill the message with, in YAML, e.g. 'data: Hello'; the rest keeps "
        "its defaults; a header may be 'auto' and a time 'now'",
        _complete_message,
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
        default=math.inf,
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
    """Publish until interrupted, or as often as the options say.

    Raises:
        VerbError: the type or the values are wrong, or too few subscribe.
    """
    message = interface_class(args.message_type, "msg")()
    stamps = fill(message, given_values(args))
    times = 1 if args.once else args.times
    with graph_node(args, args.node_name) as node:
        publisher = node.create_publisher(
            type(message), args.topic_name, profile_of(args)
        )
        clock = node.get_clock()
        finished: Future = Future()
        count = 0

        def publish() -> None:
            nonlocal count
            count += 1
            now = clock.now().to_msg()
            for stamp in stamps:
                stamp(now)
            if args.print and count % args.print == 0:
                print(f"publishing #{count}: {message!r}\n")
            publisher.publish(message)
            if count == times:
                finished.set_result(None)

        _await_subscriptions(publisher, args, default=1 if times else 0)
        print("publisher: beginning loop")
        publish()
        node.create_timer(1.0 / args.rate, caught(finished, publish))
        spin(node, finished)
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
        if waited_s >= args.max_wait_time_secs:
            raise VerbError(
                f"Timed out waiting for subscribers: Expected {wanted} subscribers but "
                f"only got {found} subscribers"
            )
        if waited_s >= reported + _WAIT_REPORT_S:
            print(f"Waiting for at least {wanted} matching subscription(s)...")
            reported = waited_s
        time.sleep(_WAIT_POLL_S)


def _complete_message(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    return [to_yaml(interface_class(parsed_args.message_type, "msg")())]
