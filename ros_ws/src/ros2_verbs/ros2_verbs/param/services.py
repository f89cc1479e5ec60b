"""A node's parameter services, and the options that lead to a node."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rclpy.task import Future

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.names import NodeName, add_node_name_argument, node_names
from ros2_verbs.graph.session import graph_node, spin, wait_until
from ros2_verbs.options import add_graph_arguments, completed, positive_float

_LATE_S = 3.5
"""A node that announces itself as Fast DDS does by default is known by then.

It answers newcomers at once, but now and then the answer is lost; the next announcement
comes up to 3 s later. The project's supervised nodes announce themselves more often.
"""
_READY_S = 5.0
_ANSWER_S = 10.0


def add_asked_node_arguments(
    parser: argparse.ArgumentParser, nargs: str | None = None
) -> None:
    """Add the name of the node, which may be missing if nargs is "?", and how to look.

    These are the options of the graph, --include-hidden-nodes and --timeout.
    """
    add_graph_arguments(parser)
    add_node_name_argument(parser, nargs)
    parser.add_argument(
        "--include-hidden-nodes",
        action="store_true",
        help="consider hidden nodes as well",
    )
    parser.add_argument(
        "--timeout",
        metavar="N",
        type=positive_float,
        default=_LATE_S,
        help="wait for N seconds until node becomes available "
        f"(default: {_LATE_S} s, what discovery takes at the worst)",
    )


def add_parameter_argument(
    parser: argparse.ArgumentParser,
    name: str = "parameter_name",
    nargs: str | None = None,
) -> None:
    """Add the name of a parameter of the node, or several if nargs is "+"."""
    completed(
        parser.add_argument(name, nargs=nargs, help="parameter, e.g. use_sim_time"),
        _complete_parameter_names,
    )


def type_name(parameter_type: int) -> str:
    """Return what a parameter type is called, such as "boolean array"."""
    name: str = Parameter.Type(parameter_type).name
    return name.lower().replace("_", " ").replace("bool", "boolean")


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
        answer = self._answer(self._client.describe_parameters(list(names)))
        return list(answer.descriptors)

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

    def delete(self, name: str) -> Any:
        """Delete a parameter; return its SetParametersResult."""
        (result,) = self._answer(self._client.delete_parameters([name])).results
        return result

    def _answer(self, future: Future) -> Any:
        if not spin(self._node, future, _ANSWER_S):
            raise VerbError(
                f"Exception while calling service of node '{self._name}': "
                f"no answer within {_ANSWER_S:g} s"
            )
        return future.result()


def connect(node: Node, args: argparse.Namespace) -> ParameterServices:
    """Wait for the node on the command line; connect to it.

    Raises:
        VerbError: it is not on the graph in time, or has no parameter services.
    """
    wanted = NodeName.parse(args.node_name)
    hidden = args.include_hidden_nodes
    if not wait_until(lambda: wanted in node_names(node, hidden=hidden), args.timeout):
        raise VerbError("Node not found")
    return ParameterServices(node, wanted.full)


@contextmanager
def parameter_services(args: argparse.Namespace) -> Iterator[ParameterServices]:
    """Join the graph and connect to the node on the command line.

    Raises:
        VerbError: the node is not there.
    """
    with graph_node(args) as node:
        yield connect(node, args)


def _complete_parameter_names(
    parsed_args: argparse.Namespace, **_: Any
) -> Sequence[str]:
    with graph_node(parsed_args) as node:
        name = NodeName.parse(parsed_args.node_name).full
        return ParameterServices(node, name).names()
