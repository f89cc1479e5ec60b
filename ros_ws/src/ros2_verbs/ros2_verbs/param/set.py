"""Set parameter."""

from __future__ import annotations

import argparse

from rclpy.parameter import Parameter

from biped_common.plain_yaml import YamlError, read_yaml
from ros2_verbs.errors import VerbError
from ros2_verbs.param.services import (
    add_asked_node_arguments,
    add_parameter_argument,
    parameter_services,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_asked_node_arguments(parser)
    add_parameter_argument(parser)
    parser.add_argument("value", help="value of the parameter, in YAML")


def main(args: argparse.Namespace) -> int:
    """Set one parameter.

    Raises:
        VerbError: the node is not there, or does not accept the value.
    """
    with parameter_services(args) as services:
        (result,) = services.set([typed_parameter(args.parameter_name, args.value)])
    reason = f": {result.reason}" if result.reason else ""
    if not result.successful:
        raise VerbError(f"Setting parameter failed{reason}")
    print(f"Set parameter successful{reason}")
    return 0


def typed_parameter(name: str, text: str) -> Parameter:
    """Return a parameter with the value that YAML reads in what the user has typed.

    Whatever YAML cannot read, and what is no parameter value (a mapping, a date, a list
    of several types), is taken as a string; on some of these rclpy's own reader fails.
    """
    try:
        value = read_yaml(text)
        return Parameter(name, value=text if value is None else value)
    except (YamlError, TypeError):
        return Parameter(name, value=text)
