"""A node's parameter services, and the options that lead to a node."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future

from ros2_verbs.arguments import positive_float
from ros2_verbs.completion import completed
from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import (
    add_graph_arguments,
    graph_node,
    spin,
    wait_until,
)
from ros2_verbs.node_names import (
    LATE_S,
    complete_node_names,
    parse,
    require_node,
)

_READY_S = 5.0
_ANSWER_S = 10.0


def add_node_name_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the name of the node and how to look for it."""
    add_graph_arguments(parser)
    completed(
        parser.add_argument("node_name", help="name of the ROS node"),
        complete_node_names,
    )
    add_hidden_and_timeout_arguments(parser)


def add_hidden_and_timeout_arguments(parser: argparse.ArgumentParser) -> None:
    """Add --include-hidden-nodes and --timeout."""
    parser.add_argument(
        "--include-hidden-nodes",
        action="store_true",
        help="consider hidden nodes as well",
    )
    parser.add_argument(
        "--timeout",
        metavar="N",
        type=positive_float,
        default=LATE_S,
        help="wait for N seconds until node becomes available "
        f"(default: {LATE_S} s, what discovery takes at the worst)",
    )


class ParameterServices:
    """Asks one node about its parameters; every question waits for its answer."""

    def __init__(self, node: Node, name: str) -> None:
        """Connect.

        Args:
            node: to ask from.
            name: of the node to be asked, fully qualified.

        Raises:
            VerbError: the node has no parameter services.
        """
        self._node = node
        self._name = name
        self._client = AsyncParameterClient(node, name)
        if not wait_until(self._client.services_are_ready, _READY_S):
            raise VerbError("Wait for service timed out")

    def names(self, prefixes: Sequence[str] = ()) -> list[str]:
        """Return the sorted names of the parameters, of those below some prefixes."""
        answer = self._answer(self._client.list_parameters(list(prefixes)))
        return sorted(answer.result.names)

    def values(self, names: Sequence[str]) -> list[Any]:
        """Return ParameterValues; none at all when a name is not declared."""
        return list(self._answer(self._client.get_parameters(list(names))).values)

    def descriptors(self, names: Sequence[str]) -> list[Any]:
        """Return ParameterDescriptors; none at all when a name is not declared."""
        return list(
            self._answer(self._client.describe_parameters(list(names))).descriptors
        )

    def set(self, parameters: Sequence[Any]) -> list[Any]:
        """Set parameters one by one; return a SetParametersResult for each.

        Raises:
            VerbError: a value does not fit into a message.
        """
        try:
            future = self._client.set_parameters(parameters)
        except AssertionError as error:  # how generated messages say so
            raise VerbError(str(error)) from None
        return list(self._answer(future).results)

    def _answer(self, future: Future) -> Any:
        if not spin(self._node, future, _ANSWER_S):
            raise VerbError(
                f"Exception while calling service of node '{self._name}': "
                f"no answer within {_ANSWER_S:g} s"
            )
        return future.result()


@contextmanager
def parameter_services(args: argparse.Namespace) -> Iterator[ParameterServices]:
    """Join the graph and connect to the node on the command line.

    Raises:
        VerbError: the node is not there.
    """
    with graph_node(args) as node:
        name = require_node(
            node,
            args.node_name,
            hidden=args.include_hidden_nodes,
            timeout_s=args.timeout,
        )
        yield ParameterServices(node, name.full)


def complete_parameter_names(
    prefix: str, parsed_args: argparse.Namespace, **_: Any
) -> Sequence[str]:
    """Return parameter names of the node on the command line, for the shell."""
    with graph_node(parsed_args) as node:
        return ParameterServices(node, parse(parsed_args.node_name).full).names()
