"""Get parameter."""

from __future__ import annotations

import argparse

from rcl_interfaces.msg import ParameterValue
from rclpy.parameter import parameter_value_to_python

from ros2_verbs.errors import VerbError
from ros2_verbs.param.services import (
    add_asked_node_arguments,
    add_parameter_argument,
    parameter_services,
    type_name,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_asked_node_arguments(parser)
    add_parameter_argument(parser)
    parser.add_argument(
        "--hide-type", action="store_true", help="hide the type information"
    )


def main(args: argparse.Namespace) -> int:
    """Print a parameter's value.

    Raises:
        VerbError: the node is not there, or has no such parameter.
    """
    with parameter_services(args) as services:
        values = services.values([args.parameter_name])
    if not values:
        raise VerbError("Parameter not set")
    print(value_text(values[0], hide_type=args.hide_type))
    return 0


def value_text(value: ParameterValue, *, hide_type: bool) -> str:
    """Return a value, with its type in front unless hidden."""
    plain = parameter_value_to_python(value)
    if hide_type:
        return str(plain)
    if plain is None:
        return "Parameter not set."
    name = type_name(value.type).capitalize()
    if name.endswith(" array"):
        return f"{name.removesuffix(' array')} values are: {plain}"
    return f"{name} value is: {plain}"
