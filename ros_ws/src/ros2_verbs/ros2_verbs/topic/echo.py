"""Output messages from a topic."""

from __future__ import annotations

import argparse
import math
from typing import Any

import yaml
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.executors import SingleThreadedExecutor
from rclpy.task import Future

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import TOPICS, class_of_topic, topic_types
from ros2_verbs.graph.qos import add_qos_arguments, listening_profile
from ros2_verbs.graph.session import caught, discover, graph_node, spin
from ros2_verbs.messages.filter import message_filter
from ros2_verbs.messages.shown import add_shown_arguments, shown_of
from ros2_verbs.messages.text import to_csv, to_json, to_yaml
from ros2_verbs.messages.types import complete_message_types, interface_class
from ros2_verbs.options import add_graph_arguments, completed, positive_float

_INFO_HEADING = "---Got new message, message info:---\n"
_DATA_HEADING = "---Message data:---\n"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    TOPICS.add_name_argument(parser)
    completed(
        parser.add_argument(
            "message_type",
            nargs="?",
            help="its type, e.g. std_msgs/msg/String; with it, a topic is waited for",
        ),
        complete_message_types,
    )
    add_qos_arguments(parser, "subscribe", "sensor_data")
    form = parser.add_mutually_exclusive_group()
    form.add_argument(
        "--csv", action="store_true", help="all fields, separated by commas"
    )
    form.add_argument(
        "--raw", action="store_true", help="the bytes as they come from the wire"
    )
    form.add_argument(
        "--json",
        action="store_true",
        help="JSON; a std_msgs/String that holds JSON is shown as what it says",
    )
    parser.add_argument(
        "--field", metavar="PATH", help="only this field, e.g. pose.pose.position"
    )
    add_shown_arguments(parser)
    parser.add_argument(
        "--no-lost-messages",
        action="store_true",
        help="do not report messages that were lost",
    )
    parser.add_argument(
        "--filter",
        metavar="EXPR",
        help="only messages for which this Python expression of m, the message or the "
        "field, is true",
    )
    parser.add_argument(
        "--once", action="store_true", help="print the first message and exit"
    )
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=positive_float,
        help="exit after this time; so long an unknown topic is waited for",
    )
    parser.add_argument(
        "-i",
        "--include-message-info",
        action="store_true",
        help="also print times and sequence numbers of each message",
    )


def main(args: argparse.Namespace) -> int:
    """Print messages until interrupted, or as the options say.

    Raises:
        VerbError: the options or the topic's type are wrong, it is not there, or the
            one message that was asked for has not come in time.
    """
    echo = _Echo(args)
    with graph_node(args) as node:
        discover(args, lambda: bool(topic_types(node, args.topic_name)))
        if args.message_type is None:
            kind = class_of_topic(node, args.topic_name, args.timeout or 0.0)
        else:
            kind = interface_class(args.message_type, "msg")
        take = caught(echo.finished, echo.take)

        def take_with_info(message: Any, info: dict[str, Any]) -> None:
            take(message, info)

        with_info = args.include_message_info
        node.create_subscription(
            kind,
            args.topic_name,
            take_with_info if with_info else take,
            listening_profile(node, args.topic_name, args),
            event_callbacks=_lost_messages(args),
            raw=args.raw,
        )
        # The events executor cannot pass the info on.
        executor = SingleThreadedExecutor() if with_info else None
        came = spin(node, echo.finished, args.timeout or math.inf, executor)
    if args.once and not came:
        raise VerbError(f"{args.topic_name}: no message came in {args.timeout:g} s")
    return 0


class _Echo:
    """Prints messages as the options say."""

    def __init__(self, args: argparse.Namespace) -> None:
        """Check the options that argparse cannot check."""
        self.finished: Future = Future()
        self._args = args
        self._path = [part for part in (args.field or "").split(".") if part]
        if args.field is not None and not self._path:
            raise VerbError(f"Invalid field value '{args.field}'")
        self._accepts = message_filter(args.filter)
        self._shown = shown_of(args)

    def take(self, message: Any, info: dict[str, Any] | None = None) -> None:
        """Print a message."""
        value = self._selected(message)
        if self._accepts is not None and not self._accepts(value):
            return
        print(self._text(value, info), end="")
        if self._args.once:
            self.finished.set_result(None)

    def _selected(self, message: Any) -> Any:
        for part in self._path:
            try:
                message = getattr(message, part)
            except AttributeError as error:
                path = ".".join(self._path)
                raise VerbError(f"Invalid field '{path}': {error}") from None
        return message

    def _text(self, value: Any, info: dict[str, Any] | None) -> str:
        is_message = hasattr(value, "get_fields_and_field_types")
        if self._args.json:
            return f"{to_json(value)}\n---\n"
        if not is_message:
            heading = f"{_INFO_HEADING}{info}\n{_DATA_HEADING}" if info else ""
            return f"{heading}{value}\n---\n"
        if self._args.csv:
            row = to_csv(value, self._shown)
            columns = [str(column) for column in (info or {}).values()]
            return ",".join([*columns, row]) + "\n"
        heading = f"{yaml.safe_dump(info)}---\n" if info else ""
        body = to_yaml(value, self._shown, self._args.flow_style)
        return f"{heading}{body}---\n"


def _lost_messages(args: argparse.Namespace) -> SubscriptionEventCallbacks | None:
    if args.no_lost_messages:
        return None

    def report(status: Any) -> None:
        print(
            f"A message was lost!!!\n\ttotal count change:{status.total_count_change}"
            f"\n\ttotal count: {status.total_count}",
            end="---\n",
        )

    return SubscriptionEventCallbacks(message_lost=report)
