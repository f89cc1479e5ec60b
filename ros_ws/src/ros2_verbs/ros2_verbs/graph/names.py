"""Names of nodes, and what all verbs share that list names."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any, NamedTuple

from rclpy.node import Node

from biped_common.terminal_text import printable
from ros2_verbs.graph.session import glance
from ros2_verbs.options import completed

_HIDDEN = "_"


class NodeName(NamedTuple):
    """A node's name within its namespace."""

    namespace: str
    name: str

    @classmethod
    def parse(cls, text: str) -> NodeName:
        """Split the name of a node, fully qualified or relative to the root."""
        namespace, _, name = f"/{text.removeprefix('/')}".rpartition("/")
        return cls(namespace or "/", name)

    @property
    def full(self) -> str:
        """Fully qualified, such as /sim_node."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


def add_node_name_argument(
    parser: argparse.ArgumentParser, nargs: str | None = None
) -> None:
    """Add the name of a node; with nargs "?" it may be missing."""
    rest = "; without it, all nodes" if nargs == "?" else ""
    completed(
        parser.add_argument(
            "node_name", nargs=nargs, help=f"node, e.g. /sim_node{rest}"
        ),
        _complete_node_names,
    )


def node_names(node: Node, *, hidden: bool) -> list[NodeName]:
    """Return the nodes on the graph, sorted; one name twice is two nodes.

    Args:
        node: that has discovered the graph.
        hidden: with those whose names begin with an underscore.
    """
    return sorted(
        NodeName(namespace, name)
        for name, namespace in node.get_node_names_and_namespaces()
        if hidden or not name.startswith(_HIDDEN)
    )


def _complete_node_names(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    names = glance(parsed_args, lambda node: node_names(node, hidden=False))
    return [name.full for name in names]


def add_count_argument(parser: argparse.ArgumentParser, things: str) -> None:
    """Add --count-THINGS, such as nodes."""
    parser.add_argument(
        "-c",
        f"--count-{things}",
        dest="only_count",
        action="store_true",
        help=f"only display the number of {things} discovered",
    )


def print_listed(args: argparse.Namespace, lines: Sequence[str]) -> None:
    """Print a line each, or how many there are."""
    for line in [str(len(lines))] if args.only_count else lines:
        print(printable(line))
