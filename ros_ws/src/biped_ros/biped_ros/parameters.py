"""Settings as ROS parameters: the same names, units, ranges and meanings.

Names are the dotted paths of the settings. At the start every parameter that a file or
a command line gives must be known, of the right type and in range. Afterwards only
`live` settings can be changed: what a walk depends on does not change under it.
"""

from __future__ import annotations

import dataclasses
from array import array
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, TypeVar, get_type_hints

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from biped_common.settings import SettingsError, from_mapping, overlay, to_mapping

Settings = TypeVar("Settings")
_LARGEST_INTEGER = 2**63 - 1
_LARGEST_FLOAT = 1.7976931348623157e308


def declared_settings(node: Node, cls: type[Settings]) -> Settings:
    """Declare a settings dataclass as parameters; return it with the values given.

    Raises:
        SettingsError: a parameter that was given is unknown, of the wrong type or out
            of range, naming it, its value and what is allowed.
    """
    # rclpy tells of parameters that nobody declared in no other way.
    given = node._parameter_overrides.values()
    settings = from_mapping(
        cls, _nested(p for p in given if not node.has_parameter(p.name))
    )
    values = flattened(to_mapping(settings))
    for name, field, kind in _fields(cls):
        if name in values:
            node.declare_parameter(
                name, values[name], _descriptor(field, kind), ignore_override=True
            )
    return settings


def changed_settings(settings: Settings, changes: Iterable[Parameter]) -> Settings:
    """Return the settings of a running node with some live ones changed.

    Raises:
        SettingsError: unknown, not live, of the wrong type or out of range, naming the
            parameter, the value and what is allowed.
    """
    changes = list(changes)
    fields = {name: (field, kind) for name, field, kind in _fields(type(settings))}
    for change in changes:
        if change.name not in fields:
            raise SettingsError(change.name, change.value, "unknown parameter")
        field, kind = fields[change.name]
        if not field.metadata["live"]:
            raise SettingsError(
                change.name,
                change.value,
                "walks depend on it; it can be given at the node's start only",
            )
        if kind is float and change.type_ == Parameter.Type.INTEGER:
            raise SettingsError(
                change.name,
                change.value,
                f"must be a number with a dot, {change.value}.0",
            )
    return from_mapping(type(settings), _nested(changes), base=settings)


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


def _nested(parameters: Iterable[Parameter]) -> Mapping[str, Any]:
    """Return parameters as nested settings, the inverse of `flattened`."""
    settings: Mapping[str, Any] = {}
    for parameter in parameters:
        value = parameter.value
        nested: Any = value.tolist() if isinstance(value, array) else value
        for part in reversed(parameter.name.split(".")):
            nested = {part: nested}
        settings = overlay(settings, nested)
    return settings


def _fields(
    cls: type[Any], prefix: str = ""
) -> Iterator[tuple[str, dataclasses.Field[Any], Any]]:
    """Yield dotted name, declaration and type of every setting."""
    hints = get_type_hints(cls)
    for field in dataclasses.fields(cls):
        kind = hints[field.name]
        if isinstance(kind, type) and dataclasses.is_dataclass(kind):
            yield from _fields(kind, f"{prefix}{field.name}.")
        else:
            yield f"{prefix}{field.name}", field, kind


def _descriptor(field: dataclasses.Field[Any], kind: Any) -> ParameterDescriptor:
    rules = field.metadata
    # As in the YAML files, [] marks a pure number.
    unit = f" [{rules['unit']}]" if kind in (int, float) or rules["unit"] else ""
    descriptor = ParameterDescriptor(
        description=f"{rules['doc']}{unit}", read_only=not rules["live"]
    )
    if rules["choices"]:
        descriptor.additional_constraints = f"one of {', '.join(rules['choices'])}"
    if rules["above"] is not None:
        descriptor.additional_constraints = f"above {rules['above']}"
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
