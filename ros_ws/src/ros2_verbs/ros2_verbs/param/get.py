"""Get parameter."""

from __future__ import annotations

import argparse

from ros2_verbs.completion import completed
from ros2_verbs.errors import VerbError
from ros2_verbs.parameter_services import (
    add_node_name_arguments,
    complete_parameter_names,
    parameter_services,
)
from ros2_verbs.parameter_text import value_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_node_name_arguments(parser)
    completed(
        parser.add_argument("parameter_name", help="name of the parameter"),
        complete_parameter_names,
    )
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
