"""Show descriptive information about declared parameters."""

from __future__ import annotations

import argparse

from ros2_verbs.completion import completed
from ros2_verbs.errors import VerbError
from ros2_verbs.parameter_services import (
    add_node_name_arguments,
    complete_parameter_names,
    parameter_services,
)
from ros2_verbs.parameter_text import description_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_node_name_arguments(parser)
    completed(
        parser.add_argument(
            "parameter_names", nargs="+", help="names of the parameters"
        ),
        complete_parameter_names,
    )


def main(args: argparse.Namespace) -> int:
    """Print what the node says of its parameters.

    Raises:
        VerbError: the node is not there, or has no such parameter.
    """
    with parameter_services(args) as services:
        descriptors = services.descriptors(args.parameter_names)
    if not descriptors:
        raise VerbError("Parameter not set")
    for descriptor in descriptors:
        print(description_text(descriptor))
    return 0
