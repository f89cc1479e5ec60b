"""Settings: plain mappings (YAML) turned into frozen, checked dataclasses.

Every number that a user may change is a field declared with `setting`, which carries
its unit, its range and one line of meaning. The same declaration serves the YAML
files, `biped check`, `--set key=value`, and ROS parameter descriptors.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

from biped_common.errors import BipedError

Settings = TypeVar("Settings")


class SettingsError(BipedError, ValueError):
    """A setting is unknown, of the wrong type or out of range.

    The message is one line: the dotted key, the value, and what is allowed.
    """

    def __init__(self, key: str, value: object, allowed: str) -> None:
        """Say which key has which unusable value, and what would be allowed."""
        super().__init__(f"{key} = {_shown(value)}: {allowed}")
        self.key = key
        self.value = value
        self.allowed = allowed

    def under(self, section: str) -> SettingsError:
        """Return the same error with its key prefixed by the enclosing section."""
        key = f"{section}.{self.key}" if section else self.key
        return SettingsError(key, self.value, self.allowed)


def _shown(value: object) -> str:
    try:
        return repr(value)
    except ValueError:
        return "a whole number of thousands of digits"  # which Python does not write


def setting(
    default: Any,
    unit: str,
    doc: str,
    *,
    lower: float | None = None,
    upper: float | None = None,
    above: float | None = None,
    choices: tuple[str, ...] | None = None,
    live: bool = False,
) -> Any:
    """Declare one field of a settings dataclass.

    Args:
        default: value where the YAML is silent.
        unit: SI unit, or "" for a pure number.
        doc: what the number means, in one line.
        lower: smallest allowed value; for a tuple, of each element.
        upper: largest allowed value.
        above: exclusive lower bound.
        choices: the allowed words, for text.
        live: may be changed while a node runs; no walk may depend on it.
    """
    metadata = {
        "unit": unit,
        "doc": doc,
        "lower": lower,
        "upper": upper,
        "above": above,
        "choices": choices,
        "live": live,
    }
    return dataclasses.field(default=default, metadata=metadata)


def section(cls: type[Settings]) -> Settings:
    """Declare a nested settings dataclass with its own defaults."""
    return dataclasses.field(default_factory=cls)


def from_mapping(
    cls: type[Settings], values: Mapping[str, Any], base: Settings | None = None
) -> Settings:
    """Build the settings dataclass `cls` from a mapping, strictly.

    Args:
        cls: frozen dataclass whose fields are made by `setting` or `section`.
        values: what the user wrote; may be partial.
        base: settings that supply what `values` leaves out (default: the defaults).

    Raises:
        SettingsError: unknown key, wrong type, non-finite or out-of-range value.
    """
    if not isinstance(values, Mapping):
        raise SettingsError("settings", values, "must be a section of keys")
    fields = {f.name: f for f in dataclasses.fields(cls)}  # type: ignore[arg-type]
    hints = get_type_hints(cls)
    arguments: dict[str, Any] = (
        {name: getattr(base, name) for name in fields} if base is not None else {}
    )
    for key, value in values.items():
        if key not in fields:
            known = ", ".join(sorted(fields))
            raise SettingsError(str(key), value, f"unknown key; known here: {known}")
        kind: Any = hints[key]
        if isinstance(kind, type) and dataclasses.is_dataclass(kind):
            if not isinstance(value, Mapping):
                raise SettingsError(key, value, "must be a section of keys")
            try:
                arguments[key] = from_mapping(kind, value, arguments.get(key))
            except SettingsError as error:
                raise error.under(key) from None
        else:
            arguments[key] = _converted(key, value, kind, fields[key])
    return cls(**arguments)


def to_mapping(settings: Any) -> dict[str, Any]:
    """Return nested plain values (lists, not tuples), the inverse of `from_mapping`."""
    result: dict[str, Any] = {}
    for f in dataclasses.fields(settings):
        value = getattr(settings, f.name)
        if dataclasses.is_dataclass(value):
            result[f.name] = to_mapping(value)
        else:
            result[f.name] = list(value) if isinstance(value, tuple) else value
    return result


def overlay(base: Mapping[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return `base` with `changes` laid over it, section by section."""
    merged = dict(base)
    for key, value in changes.items():
        under = merged.get(key)
        if isinstance(under, Mapping) and isinstance(value, Mapping):
            merged[key] = overlay(under, value)
        else:
            merged[key] = value
    return merged


def check_ranges(settings: Any) -> None:
    """Check every field of a settings object against its declaration.

    Called from the `__post_init__` of each settings dataclass, so that an invalid
    object cannot be made in code either.

    Raises:
        SettingsError: naming the key, the value and what is allowed.
    """
    hints = get_type_hints(type(settings))
    for f in dataclasses.fields(settings):
        if "unit" in f.metadata:
            value = getattr(settings, f.name)
            _converted(f.name, value, hints[f.name], f)
            _check_range(f.name, value, f)


def _converted(key: str, value: Any, kind: Any, field: dataclasses.Field[Any]) -> Any:
    if get_origin(kind) is tuple:
        element = get_args(kind)[0]
        if not isinstance(value, (list, tuple)):
            raise SettingsError(key, value, f"must be a list of {element.__name__}")
        return tuple(_converted(key, v, element, field) for v in value)
    if isinstance(value, bool) != (kind is bool):
        raise SettingsError(key, value, f"must be {_NOUNS[kind]}")
    if kind is float and isinstance(value, int):
        try:
            return float(value)
        except OverflowError:
            raise SettingsError(key, value, "is too large a number") from None
    if not isinstance(value, kind):
        raise SettingsError(key, value, f"must be {_NOUNS[kind]}{_hint(value)}")
    return value


_NOUNS = {float: "a number", int: "a whole number", bool: "true or false", str: "text"}


def _hint(value: object) -> str:
    # YAML 1.1 reads 1e-3 as text: the commonest surprise deserves its own word.
    if isinstance(value, str):
        try:
            float(value)
        except ValueError:
            return ""
        return " (YAML wants a dot in the mantissa, as in 1.0e-3)"
    return ""


def _check_range(key: str, value: Any, field: dataclasses.Field[Any]) -> None:
    if isinstance(value, tuple):
        for element in value:
            _check_range(key, element, field)
        return
    rules = field.metadata
    unit = f" {rules['unit']}" if rules["unit"] else ""
    if isinstance(value, float) and not math.isfinite(value):
        raise SettingsError(key, value, "must be a finite number")
    if rules["choices"] is not None and value not in rules["choices"]:
        raise SettingsError(key, value, f"must be one of {', '.join(rules['choices'])}")
    if rules["above"] is not None and value <= rules["above"]:
        raise SettingsError(key, value, f"must be above {rules['above']}{unit}")
    lower, upper = rules["lower"], rules["upper"]
    if (lower is not None and value < lower) or (upper is not None and value > upper):
        if lower is None:
            allowed = f"must be at most {upper}{unit}"
        elif upper is None:
            allowed = f"must be at least {lower}{unit}"
        else:
            allowed = f"must be between {lower} and {upper}{unit}"
        raise SettingsError(key, value, allowed)
