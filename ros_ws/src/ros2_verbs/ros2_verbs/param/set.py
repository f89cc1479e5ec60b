"""Set parameter."""

from __future__ import annotations

import argparse

from ros2_verbs.completion import completed
from ros2_verbs.errors import VerbError
from ros2_verbs.parameter_services import (
    add_node_name_arguments,
    complete_parameter_names,
    parameter_services,
)
from ros2_verbs.parameter_text import reason_text, typed_parameter


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_node_name_arguments(parser)
    completed(
        parser.add_argument("parameter_name", help="name of the parameter"),
        complete_parameter_names,
    )
    parser.add_argument("value", help="value of the parameter, in YAML")


def main(args: argparse.Namespace) -> int:
    """Set one parameter.

    Raises:
        VerbError: the node is not there, or does not accept the value.
    """
    with parameter_services(args) as services:
        (result,) = services.set([typed_parameter(args.parameter_name, args.value)])
    reason = reason_text(result)
    if not result.successful:
        raise VerbError(f"Setting parameter failed{reason}")
    print(f"Set parameter successful{reason}")
    return 0
