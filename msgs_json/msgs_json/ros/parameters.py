"""Settings as ROS parameters: the same names, units, ranges and meanings."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, TypeVar, get_type_hints

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from msgs_json.settings import from_mapping, to_mapping

Settings = TypeVar("Settings")
_LARGEST_INTEGER = 2**63 - 1
_LARGEST_FLOAT = 1.7976931348623157e308


def declared_settings(node: Node, cls: type[Settings]) -> Settings:
    """Declare a settings dataclass as parameters; return it with the values given.

    Parameters are named by the dotted path of the setting. They are read-only: what a
    walk depends on cannot change under it, and a new value wants a new start.

    Raises:
        SettingsError: a value is out of range, naming key, value and what is allowed.
    """
    return from_mapping(cls, _declared(node, cls, ""))


def parameters_of(settings: Any) -> list[Parameter]:
    """Return the parameters that make `declared_settings` return these settings."""
    return [
        Parameter(name, value=value)
        for name, value in flattened(to_mapping(settings)).items()
    ]


def flattened(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return nested settings by dotted name, as parameter files want them."""
    flat: dict[str, Any] = {}
    for key, value in values.items():
        if isinstance(value, Mapping):
            flat.update(flattened(value, f"{prefix}{key}."))
        elif value != []:  # an empty list has no type in ROS
            flat[f"{prefix}{key}"] = value
    return flat


def _declared(node: Node, cls: type[Any], prefix: str) -> dict[str, Any]:
    values: dict[str, Any] = {}
    hints = get_type_hints(cls)
    for field in dataclasses.fields(cls):
        kind = hints[field.name]
        if isinstance(kind, type) and dataclasses.is_dataclass(kind):
            values[field.name] = _declared(node, kind, f"{prefix}{field.name}.")
        elif field.default != ():  # an empty list has no type in ROS
            parameter = node.declare_parameter(
                f"{prefix}{field.name}", field.default, _descriptor(field, kind)
            )
            values[field.name] = parameter.value
    return values


def _descriptor(field: dataclasses.Field[Any], kind: Any) -> ParameterDescriptor:
    rules = field.metadata
    unit = f" [{rules['unit']}]" if rules["unit"] else ""
    descriptor = ParameterDescriptor(
        description=f"{rules['doc']}{unit}", read_only=True
    )
    if rules["choices"]:
        descriptor.additional_constraints = f"one of {', '.join(rules['choices'])}"
    lower = rules["lower"] if rules["lower"] is not None else rules["above"]
    upper = rules["upper"]
    if kind is float and (lower is not None or upper is not None):
        bounds = FloatingPointRange(
            from_value=-_LARGEST_FLOAT if lower is None else float(lower),
            to_value=_LARGEST_FLOAT if upper is None else float(upper),
        )
        descriptor.floating_point_range = [bounds]
    if kind is int and (lower is not None or upper is not None):
        whole = IntegerRange(
            from_value=-_LARGEST_INTEGER if lower is None else int(lower),
            to_value=_LARGEST_INTEGER if upper is None else int(upper),
        )
        descriptor.integer_range = [whole]
    return descriptor
