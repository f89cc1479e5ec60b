"""What TAB offers: topics by a quick look at the graph, types from the index."""

from __future__ import annotations

import argparse
from typing import Any

from ros2_verbs import message_types


def topic_names(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Offer the topics that are found at once."""
    from ros2_verbs.graph_node import glance, graph_node
    from ros2_verbs.topics import topics_and_types

    with graph_node(argparse.Namespace()) as node:
        glance(node)
        hidden = getattr(parsed_args, "include_hidden_topics", False)
        return [name for name, _ in topics_and_types(node, include_hidden=hidden)]


def message_names(**_: Any) -> list[str]:
    """Offer all message types."""
    return message_types.all_interfaces("msg")


def interface_names(**_: Any) -> list[str]:
    """Offer all messages, services and actions."""
    return [
        name
        for kind in message_types.KINDS
        for name in message_types.all_interfaces(kind)
    ]


def package_names(**_: Any) -> list[str]:
    """Offer the packages that have interfaces."""
    return message_types.packages()


def message_prototype(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    """Offer the default message of the chosen type, to be edited."""
    from ros2_verbs.message_yaml import to_yaml

    return [to_yaml(message_types.message_class(parsed_args.message_type)())]


def completed(action: argparse.Action, completer: Any) -> None:
    """Have argcomplete ask a function for an argument's values."""
    # argcomplete looks for this attribute, which argparse does not declare.
    action.completer = completer  # type: ignore[attr-defined]
