"""Show all of the parameters of a node in a YAML file format."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import Any

import yaml
from rclpy.parameter import PARAMETER_SEPARATOR_STRING, parameter_value_to_python

from ros2_verbs.graph.names import NodeName
from ros2_verbs.param.services import add_asked_node_arguments, parameter_services


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_asked_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print a node's parameters as a file for `ros2 param load` and --params-file.

    Raises:
        VerbError: the node is not there.
    """
    with parameter_services(args) as services:
        names = services.names()
        values = [parameter_value_to_python(value) for value in services.values(names)]
    node_name = NodeName.parse(args.node_name).full
    print(dump_text(node_name, zip(names, values, strict=True)))
    return 0


def dump_text(node_name: str, parameters: Iterable[tuple[str, Any]]) -> str:
    """Return parameters as a parameter file for the node.

    Args:
        node_name: fully qualified.
        parameters: dotted names and values.
    """
    tree: dict[str, Any] = {}
    for name, value in parameters:
        *folders, leaf = name.split(PARAMETER_SEPARATOR_STRING)
        branch = tree
        for folder in folders:
            branch = branch.setdefault(folder, {})
        branch[leaf] = value
    whole = {node_name: {"ros__parameters": tree}}
    return str(yaml.dump(whole, default_flow_style=False))
