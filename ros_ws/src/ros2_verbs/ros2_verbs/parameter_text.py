"""Parameters as text: values and descriptions to print, and values that were typed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import yaml
from rcl_interfaces.msg import (
    ParameterDescriptor,
    ParameterType,
    ParameterValue,
    SetParametersResult,
)
from rclpy.parameter import (
    PARAMETER_SEPARATOR_STRING,
    Parameter,
    parameter_value_to_python,
)

_TYPES = {
    ParameterType.PARAMETER_BOOL: ("boolean", "Boolean value is:"),
    ParameterType.PARAMETER_INTEGER: ("integer", "Integer value is:"),
    ParameterType.PARAMETER_DOUBLE: ("double", "Double value is:"),
    ParameterType.PARAMETER_STRING: ("string", "String value is:"),
    ParameterType.PARAMETER_BYTE_ARRAY: ("byte array", "Byte values are:"),
    ParameterType.PARAMETER_BOOL_ARRAY: ("boolean array", "Boolean values are:"),
    ParameterType.PARAMETER_INTEGER_ARRAY: ("integer array", "Integer values are:"),
    ParameterType.PARAMETER_DOUBLE_ARRAY: ("double array", "Double values are:"),
    ParameterType.PARAMETER_STRING_ARRAY: ("string array", "String values are:"),
    ParameterType.PARAMETER_NOT_SET: ("not set", "Parameter not set."),
}


def type_name(parameter_type: int) -> str:
    """Return what a parameter type is called."""
    return _TYPES[parameter_type][0]


def value_text(value: ParameterValue, *, hide_type: bool) -> str:
    """Return a value, with its type in front unless hidden."""
    plain = parameter_value_to_python(value)
    if hide_type:
        return str(plain)
    label = _TYPES[value.type][1]
    return label if plain is None else f"{label} {plain}"


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


def loaded_text(name: str, result: SetParametersResult) -> str:
    """Return what became of one parameter of a file."""
    outcome = "successful" if result.successful else "failed"
    return f"Set parameter {name} {outcome}{reason_text(result)}"


def reason_text(result: SetParametersResult) -> str:
    """Return the node's reason with a colon in front, if it gave one."""
    return f": {result.reason}" if result.reason else ""


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


def typed_parameter(name: str, text: str) -> Parameter:
    """Return a parameter with the value that YAML reads in what the user has typed.

    Whatever YAML cannot read, and what is no parameter value (a mapping, a date, a list
    of several types), is taken as a string.
    """
    try:
        value = yaml.safe_load(text)
        return Parameter(name, value=text if value is None else value)
    except (yaml.YAMLError, TypeError):
        return Parameter(name, value=text)
