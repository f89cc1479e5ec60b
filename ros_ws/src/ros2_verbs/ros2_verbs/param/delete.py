"""Delete parameter."""

from __future__ import annotations

import argparse

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


def main(args: argparse.Namespace) -> int:
    """Delete one parameter.

    Raises:
        VerbError: the node is not there, or keeps the parameter.
    """
    with parameter_services(args) as services:
        result = services.delete(args.parameter_name)
    reason = f": {result.reason}" if result.reason else ""
    if not result.successful:
        raise VerbError(f"Deleting parameter failed{reason}")
    print(f"Deleted parameter successfully{reason}")
    return 0
