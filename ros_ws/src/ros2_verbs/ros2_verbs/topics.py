"""Topics on the graph: their names and types, looked up and waited for."""

from __future__ import annotations

import argparse
import time
from typing import Any

from rclpy.exceptions import InvalidTopicNameException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.validate_full_topic_name import validate_full_topic_name

from ros2_verbs.errors import VerbError
from ros2_verbs.message_types import message_class

_POLL_S = 0.1


def topics_and_types(
    node: Node, *, include_hidden: bool
) -> list[tuple[str, list[str]]]:
    """Return what is known so far, sorted by name."""
    return [
        (name, types)
        for name, types in sorted(node.get_topic_names_and_types())
        if include_hidden or not topic_or_service_is_hidden(name)
    ]


def add_hidden_topics_argument(parser: argparse.ArgumentParser) -> None:
    """Add --include-hidden-topics."""
    parser.add_argument(
        "--include-hidden-topics",
        action="store_true",
        help="consider hidden topics as well",
    )


def full_name(node: Node, topic: str) -> str:
    """Return the name of a topic from the root.

    Raises:
        VerbError: no topic can have such a name.
    """
    try:
        name: str = expand_topic_name(topic, node.get_name(), node.get_namespace())
        validate_full_topic_name(name)
    except (ValueError, InvalidTopicNameException) as error:
        raise VerbError(f"'{topic}': {error}") from None
    return name


def is_known(node: Node, topic: str) -> bool:
    """Return whether a topic is on the graph, as far as is known."""
    return full_name(node, topic) in dict(node.get_topic_names_and_types())


def class_of_topic(
    node: Node, topic: str, timeout_s: float | None = 0.0, verb: str = "echo"
) -> Any:
    """Return the message class of a topic.

    Args:
        node: has had its time to discover.
        topic: its name, perhaps relative.
        timeout_s: how long to wait for it to appear; None waits for ever.
        verb: what cannot be done with a topic of two types.

    Raises:
        VerbError: it has more than one type, or has not appeared.
    """
    name = full_name(node, topic)
    end = None if timeout_s is None else time.monotonic() + timeout_s
    warned = False
    while not (types := dict(node.get_topic_names_and_types()).get(name)):
        if not warned:
            print(f"WARNING: topic [{topic}] does not appear to be published yet")
            warned = True
        if end is not None and time.monotonic() >= end:
            raise VerbError("Could not determine the type for the passed topic")
        time.sleep(_POLL_S)
    if len(types) > 1:
        raise VerbError(
            f"Cannot {verb} topic '{topic}', as it contains more than one type: "
            f"[{', '.join(types)}]"
        )
    return message_class(types[0])
