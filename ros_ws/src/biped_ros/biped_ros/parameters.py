"""Settings as ROS parameters: the same names, units, ranges and meanings.

Names are the dotted paths of the settings. At the start every parameter that a file or
a command line gives must be known, of the right type and in range. Afterwards only
`live` settings can be changed: what a walk depends on does not change under it.
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from biped_common.settings import (
    AnySettings,
    Declaration,
    SettingsError,
    declarations,
    dotted,
    from_mapping,
    nested,
    overlay,
    to_mapping,
)

# Descriptor field, message and largest number of a range, by type of the setting.
_RANGES: dict[type, tuple[str, Any, float]] = {
    float: ("floating_point_range", FloatingPointRange, sys.float_info.max),
    int: ("integer_range", IntegerRange, 2**63 - 1),
}


def declared_settings(node: Node, cls: type[AnySettings]) -> AnySettings:
    """Declare a settings dataclass as parameters; return it with the values given.

    Raises:
        SettingsError: a parameter that was given is unknown, of the wrong type or out
            of range, naming it, its value and what is allowed.
    """
    # rclpy tells of parameters that nobody declared in no other way.
    given = node._parameter_overrides.values()
    settings = from_mapping(
        cls, _mapping(p for p in given if not node.has_parameter(p.name))
    )
    values = flattened(to_mapping(settings))
    for name, declared in _declarations(cls):
        if name in values:
            node.declare_parameter(
                name, values[name], _descriptor(declared), ignore_override=True
            )
    return settings


def changed_settings(
    settings: AnySettings, changes: Iterable[Parameter]
) -> AnySettings:
    """Return the settings of a running node with some live ones changed.

    Raises:
        SettingsError: unknown, not live, of the wrong type or out of range, naming the
            parameter, the value and what is allowed.
    """
    changes = list(changes)
    known = dict(_declarations(type(settings)))
    for change in changes:
        name, value = change.name, change.value
        if name not in known:
            raise SettingsError(name, value, "unknown parameter")
        if not known[name].rules["live"]:
            raise SettingsError(
                name,
                value,
                "walks depend on it; it can be given at the node's start only",
            )
        if known[name].kind is float and change.type_ == Parameter.Type.INTEGER:
            raise SettingsError(name, value, f"must be a number with a dot, {value}.0")
    return from_mapping(type(settings), _mapping(changes), base=settings)


def parameters_of(settings: Any) -> list[Parameter]:
    """Return the parameters that make `declared_settings` return these settings."""
    return [
        Parameter(name, value=value)
        for name, value in flattened(to_mapping(settings)).items()
    ]


def flattened(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return nested settings by dotted name, as parameter files want them."""
    # An empty list has no type in ROS.
    return {name: value for name, value in dotted(values).items() if value != []}


def _mapping(parameters: Iterable[Parameter]) -> Mapping[str, Any]:
    """Return parameters as nested settings, the inverse of `flattened`."""
    settings: Mapping[str, Any] = {}
    for parameter in parameters:
        value = parameter.value
        plain = value.tolist() if isinstance(value, array) else value
        settings = overlay(settings, nested(parameter.name, plain))
    return settings


def _declarations(
    cls: type[Any], prefix: str = ""
) -> Iterator[tuple[str, Declaration]]:
    """Yield every setting's dotted name and what is declared of it."""
    for name, declared in declarations(cls).items():
        if declared.is_section:
            yield from _declarations(declared.kind, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", declared


def _descriptor(declared: Declaration) -> ParameterDescriptor:
    kind, rules = declared.kind, declared.rules
    # As in the YAML files, [] marks a pure number.
    unit = f" [{rules['unit']}]" if kind in _RANGES or rules["unit"] else ""
    descriptor = ParameterDescriptor(
        description=f"{rules['doc']}{unit}", read_only=not rules["live"]
    )
    if rules["choices"]:
        descriptor.additional_constraints = f"one of {', '.join(rules['choices'])}"
    if rules["above"] is not None:
        descriptor.additional_constraints = f"above {rules['above']}"
    lower = rules["above"] if rules["lower"] is None else rules["lower"]
    upper = rules["upper"]
    if kind in _RANGES and not lower is upper is None:
        field, message, largest = _RANGES[kind]
        bounds = message(
            from_value=kind(-largest if lower is None else lower),
            to_value=kind(largest if upper is None else upper),
        )
        setattr(descriptor, field, [bounds])
    return descriptor
