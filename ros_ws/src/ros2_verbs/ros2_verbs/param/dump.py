"""Show all of the parameters of a node in a YAML file format."""

from __future__ import annotations

import argparse

from rclpy.parameter import parameter_value_to_python

from ros2_verbs.node_names import absolute
from ros2_verbs.parameter_services import (
    add_node_name_arguments,
    parameter_services,
)
from ros2_verbs.parameter_text import dump_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_node_name_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Print a node's parameters as a file for `ros2 param load` and --params-file.

    Raises:
        VerbError: the node is not there.
    """
    with parameter_services(args) as services:
        names = services.names()
        values = [parameter_value_to_python(value) for value in services.values(names)]
    print(dump_text(absolute(args.node_name), zip(names, values, strict=True)))
    return 0
