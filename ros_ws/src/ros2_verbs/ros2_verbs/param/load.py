"""Load parameter file for a node."""

from __future__ import annotations

import argparse
import sys

from ros2_verbs.node_names import absolute
from ros2_verbs.parameter_file import parameters_from_file
from ros2_verbs.parameter_services import (
    add_node_name_arguments,
    parameter_services,
)
from ros2_verbs.parameter_text import loaded_text


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_node_name_arguments(parser)
    parser.add_argument("parameter_file", help="parameter file, in YAML")
    parser.add_argument(
        "--no-use-wildcard",
        action="store_true",
        help="do not load parameters in the '/**' namespace into the node",
    )


def main(args: argparse.Namespace) -> int:
    """Set what the file says, one by one; status 1 if the node refused any.

    Raises:
        VerbError: the file is none for this node, or the node is not there.
    """
    parameters = parameters_from_file(
        args.parameter_file,
        absolute(args.node_name),
        wildcard=not args.no_use_wildcard,
    )
    with parameter_services(args) as services:
        results = services.set(parameters)
    for parameter, result in zip(parameters, results, strict=True):
        print(
            loaded_text(parameter.name, result),
            file=sys.stdout if result.successful else sys.stderr,
        )
    return 0 if all(result.successful for result in results) else 1
