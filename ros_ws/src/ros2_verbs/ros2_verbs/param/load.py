"""Load parameter file for a node.

Not by rclpy's reader: that takes a quoted number for a number, and fails where a file
has values for all nodes only.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import yaml
from rcl_interfaces.msg import SetParametersResult
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.names import NodeName
from ros2_verbs.param.services import (
    ParameterServices,
    add_asked_node_arguments,
    parameter_services,
)

_WILDCARD = "/**"
_KEY = "ros__parameters"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_asked_node_arguments(parser)
    parser.add_argument("parameter_file", help="parameter file, in YAML")
    parser.add_argument(
        "--no-use-wildcard",
        action="store_true",
        help="do not load parameters in the '/**' namespace into the node",
    )


def main(args: argparse.Namespace) -> int:
    """Set what the file says, one by one; status 1 if the node refused any.

    A value that the node has already is no refusal: what was dumped can be loaded.

    Raises:
        VerbError: the file is none for this node, or the node is not there.
    """
    parameters = parameters_from_file(
        args.parameter_file,
        NodeName.parse(args.node_name).full,
        wildcard=not args.no_use_wildcard,
    )
    with parameter_services(args) as services:
        results = _set(services, parameters)
    for parameter, result in zip(parameters, results, strict=True):
        print(
            loaded_text(parameter.name, result),
            file=sys.stdout if result.successful else sys.stderr,
        )
    return 0 if all(result.successful for result in results) else 1


def _set(
    services: ParameterServices, parameters: Sequence[Parameter]
) -> list[SetParametersResult]:
    results = services.set(parameters)
    refused = [
        parameter.name
        for parameter, result in zip(parameters, results, strict=True)
        if not result.successful
    ]
    declared = sorted({*services.names()}.intersection(refused)) if refused else []
    there = dict(zip(declared, services.values(declared), strict=True))
    return [
        SetParametersResult(successful=True, reason="unchanged")
        if there.get(parameter.name) == parameter.get_parameter_value()
        else result
        for parameter, result in zip(parameters, results, strict=True)
    ]


def loaded_text(name: str, result: SetParametersResult) -> str:
    """Return what became of one parameter of a file."""
    outcome = "successful" if result.successful else "failed"
    reason = f": {result.reason}" if result.reason else ""
    return f"Set parameter {name} {outcome}{reason}"


def parameters_from_file(
    path: str, node_name: str, *, wildcard: bool
) -> list[Parameter]:
    """Return what a parameter file sets for a node, in the order of the file.

    Args:
        path: of the YAML file.
        node_name: fully qualified; in the file the leading slash may be missing.
        wildcard: with what is set for all nodes; the node's own values win.

    Raises:
        VerbError: no YAML, not a parameter file, or nothing for this node.
        OSError: the file cannot be read.
    """
    nodes = _read(path)
    chosen = [
        name
        for name in (_WILDCARD, node_name.removeprefix("/"), node_name)
        if name in nodes and (wildcard or name != _WILDCARD)
    ]
    if not chosen:
        raise VerbError(
            f"Param file does not contain parameters for {node_name}, "
            f"only for nodes: {list(nodes)}"
        )
    values: dict[str, Any] = {}
    for name in chosen:
        section = nodes[name]
        if not (isinstance(section, dict) and isinstance(section.get(_KEY), dict)):
            raise VerbError(
                f"YAML file is not a valid ROS parameter file for node {name}"
            )
        values.update(_flattened(section[_KEY]))
    return [_parameter(path, name, value) for name, value in values.items()]


def _read(path: str) -> dict[str, Any]:
    with open(path) as file:
        try:
            nodes = yaml.safe_load(file)
        except (yaml.YAMLError, UnicodeDecodeError) as error:
            raise VerbError(f"{path}: is no YAML: {error}") from None
    if not isinstance(nodes, dict):
        raise VerbError(f"{path}: must map node names to {_KEY}")
    return nodes


def _flattened(
    values: Mapping[str, Any], prefix: str = ""
) -> Iterator[tuple[str, Any]]:
    for key, value in values.items():
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{key}{PARAMETER_SEPARATOR_STRING}")
        else:
            yield f"{prefix}{key}", value


def _parameter(path: str, name: str, value: Any) -> Parameter:
    try:
        return Parameter(name, value=value)
    except TypeError:
        raise VerbError(
            f"{path}: {name}: must be a boolean, a number, a string, or a list of one "
            f"of them, not {value!r}"
        ) from None
