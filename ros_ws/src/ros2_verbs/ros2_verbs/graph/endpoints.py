"""Topics and services on the graph: found by name, listed with their types."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.exceptions import InvalidTopicNameException
from rclpy.expand_topic_name import expand_topic_name
from rclpy.node import Node
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden
from rclpy.validate_full_topic_name import validate_full_topic_name

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.names import add_count_argument
from ros2_verbs.graph.session import discover, glance, whole_graph
from ros2_verbs.messages.types import interface_class
from ros2_verbs.options import add_graph_arguments, completed

NamesAndTypes = Sequence[tuple[str, Sequence[str]]]

_POLL_S = 0.1


@dataclass(frozen=True)
class EndpointKind:
    """Topics, or services: what verbs ask of both alike."""

    noun: str
    example: str
    names_and_types: Callable[[Node], NamesAndTypes]

    def add_name_argument(self, parser: argparse.ArgumentParser) -> None:
        """Add the name of one, such as topic_name."""
        completed(
            parser.add_argument(
                f"{self.noun}_name", help=f"{self.noun}, e.g. {self.example}"
            ),
            self.complete_names,
        )

    def add_hidden_argument(self, parser: argparse.ArgumentParser) -> None:
        """Add --include-hidden-topics, or -services."""
        parser.add_argument(
            f"--include-hidden-{self.noun}s",
            dest="include_hidden",
            action="store_true",
            help=f"consider hidden {self.noun}s as well",
        )

    def add_listing_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add what a verb takes that lists some of them."""
        add_graph_arguments(parser)
        add_count_argument(parser, f"{self.noun}s")
        self.add_hidden_argument(parser)

    def add_show_types_argument(self, parser: argparse.ArgumentParser) -> None:
        """Add --show-types."""
        parser.add_argument(
            "-t",
            "--show-types",
            action="store_true",
            help=f"additionally show the {self.noun} type",
        )

    def known(self, node: Node, *, hidden: bool) -> NamesAndTypes:
        """Return what the node has discovered so far, sorted by name."""
        return sorted(
            (name, types)
            for name, types in self.names_and_types(node)
            if hidden or not topic_or_service_is_hidden(name)
        )

    def found(self, args: argparse.Namespace) -> NamesAndTypes:
        """Return what is on the graph, sorted by name."""
        hidden = args.include_hidden
        return whole_graph(args, lambda node: self.known(node, hidden=hidden))

    def await_types(
        self,
        node: Node,
        name: str,
        args: argparse.Namespace,
        *,
        at_once: bool = True,
    ) -> Sequence[str]:
        """Return the types under a name, none if it never is known.

        Args:
            node: to look from.
            name: from the root.
            args: of the verb.
            at_once: as soon as it is known; else those who have it get time, too.
        """

        def types() -> Sequence[str]:
            return dict(self.known(node, hidden=args.include_hidden)).get(name, [])

        discover(args, lambda: bool(types()), at_once=at_once)
        return types()

    def complete_names(self, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
        """Return their names, for the shell."""
        return [name for name, _ in self._glance(parsed_args)]

    def complete_types(self, parsed_args: argparse.Namespace, **_: Any) -> list[str]:
        """Return the types of the one on the command line, or of all, for the shell."""
        named = getattr(parsed_args, f"{self.noun}_name", None)
        return sorted(
            {
                type_name
                for name, types in self._glance(parsed_args)
                if named in (None, name)
                for type_name in types
            }
        )

    def _glance(self, args: argparse.Namespace) -> NamesAndTypes:
        hidden = getattr(args, "include_hidden", False)
        return glance(args, lambda node: self.known(node, hidden=hidden))


TOPICS = EndpointKind("topic", "/joint_states", Node.get_topic_names_and_types)
SERVICES = EndpointKind("service", "/sim_node/pause", Node.get_service_names_and_types)


def with_types(args: argparse.Namespace, found: NamesAndTypes) -> list[str]:
    """Return a line for each name, with its types if they are to be shown."""
    return [
        f"{name} [{', '.join(types)}]" if args.show_types else name
        for name, types in found
    ]


def full_topic_name(node: Node, topic: str) -> str:
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


def topic_types(node: Node, topic: str) -> Sequence[str]:
    """Return the types of a topic, none as long as it is not known."""
    known = dict(TOPICS.known(node, hidden=True))
    return known.get(full_topic_name(node, topic), [])


def class_of_topic(node: Node, topic: str, timeout_s: float, verb: str = "echo") -> Any:
    """Return the message class of a topic.

    Args:
        node: has had its time to discover.
        topic: its name, perhaps relative.
        timeout_s: how long to wait for it to appear.
        verb: what cannot be done with a topic of two types.

    Raises:
        VerbError: it has more than one type, or has not appeared.
    """
    end = time.monotonic() + timeout_s
    warned = False
    while not (types := topic_types(node, topic)):
        if not warned:
            print(f"WARNING: topic [{topic}] does not appear to be published yet")
            warned = True
        if time.monotonic() >= end:
            raise VerbError("Could not determine the type for the passed topic")
        time.sleep(_POLL_S)
    if len(types) > 1:
        raise VerbError(
            f"Cannot {verb} topic '{topic}', as it contains more than one type: "
            f"[{', '.join(types)}]"
        )
    return interface_class(types[0], "msg")
