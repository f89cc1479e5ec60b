"""Names of nodes: hidden ones, relative ones, and waiting for one to appear."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any, NamedTuple

from rclpy.node import Node

from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import (
    HIDDEN_PREFIX,
    glance,
    graph_node,
    wait_until,
)

LATE_S = 3.5
"""A node that announces itself as Fast DDS does by default is known by then.

It answers newcomers at once, but now and then the answer is lost; the next announcement
comes up to 3 s later. The project's supervised nodes announce themselves more often.
"""


class NodeName(NamedTuple):
    """A node's name within its namespace."""

    namespace: str
    name: str

    @property
    def full(self) -> str:
        """Fully qualified, such as /sim_node."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


def absolute(name: str) -> str:
    """Return a node's name with its leading slash."""
    return name if name.startswith("/") else f"/{name}"


def parse(name: str) -> NodeName:
    """Split the name of a node, fully qualified or relative to the root."""
    namespace, _, base = absolute(name).rpartition("/")
    return NodeName(namespace or "/", base)


def node_names(node: Node, *, hidden: bool) -> list[NodeName]:
    """Return the nodes on the graph, sorted; one name twice is two nodes.

    Args:
        node: that has discovered the graph.
        hidden: with those whose names begin with an underscore.
    """
    return sorted(
        NodeName(namespace, name)
        for name, namespace in node.get_node_names_and_namespaces()
        if hidden or not name.startswith(HIDDEN_PREFIX)
    )


def require_node(node: Node, name: str, *, hidden: bool, timeout_s: float) -> NodeName:
    """Wait for a node.

    Raises:
        VerbError: it is not on the graph in time.
    """
    wanted = parse(name)
    if not wait_until(lambda: wanted in node_names(node, hidden=hidden), timeout_s):
        raise VerbError("Node not found")
    return wanted


def complete_node_names(
    prefix: str, parsed_args: argparse.Namespace, **_: Any
) -> Sequence[str]:
    """Return node names for the shell."""
    with graph_node(parsed_args) as node:
        glance(node)
        return [name.full for name in node_names(node, hidden=False)]
