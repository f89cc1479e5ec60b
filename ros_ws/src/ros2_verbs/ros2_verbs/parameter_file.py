"""Parameter files: YAML of node names, `ros__parameters` and nested names."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import yaml
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, Parameter

from ros2_verbs.errors import VerbError

WILDCARD = "/**"
_KEY = "ros__parameters"


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
        for name in (WILDCARD, node_name.removeprefix("/"), node_name)
        if name in nodes and (wildcard or name != WILDCARD)
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
        values.update(_flattened(section[_KEY], ""))
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


def _flattened(values: Mapping[str, Any], prefix: str) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            flat.update(_flattened(value, f"{prefix}{key}{PARAMETER_SEPARATOR_STRING}"))
        else:
            flat[f"{prefix}{key}"] = value
    return flat


def _parameter(path: str, name: str, value: Any) -> Parameter:
    try:
        return Parameter(name, value=value)
    except TypeError:
        raise VerbError(
            f"{path}: {name}: must be a boolean, a number, a string, or a list of one "
            f"of them, not {value!r}"
        ) from None
