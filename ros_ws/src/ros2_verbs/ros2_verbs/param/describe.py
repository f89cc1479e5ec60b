"""Show descriptive information about declared parameters."""

from __future__ import annotations

import argparse

from rcl_interfaces.msg import ParameterDescriptor

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
    add_parameter_argument(parser, "parameter_names", nargs="+")


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


def description_text(descriptor: ParameterDescriptor) -> str:
    """Return name, type, description and constraints, one a line."""
    lines = [
        f"Parameter name: {descriptor.name}",
        f"  Type: {type_name(descriptor.type)}",
    ]
    if descriptor.description:
        lines.append(f"  Description: {descriptor.description}")
    lines.append("  Constraints:")
    if descriptor.read_only:
        lines.append("    Read only: true")
    for bounds in (*descriptor.floating_point_range, *descriptor.integer_range):
        lines.append(f"    Min value: {bounds.from_value}")
        lines.append(f"    Max value: {bounds.to_value}")
        if bounds.step:
            lines.append(f"    Step: {bounds.step}")
    if descriptor.additional_constraints:
        lines.append(f"    Additional constraints: {descriptor.additional_constraints}")
    return "\n".join(lines)
