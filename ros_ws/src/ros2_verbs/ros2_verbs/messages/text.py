"""Messages as people read them: YAML, comma-separated values, JSON."""

from __future__ import annotations

import array
import json
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import yaml
from rosidl_parser.definition import (
    AbstractString,
    AbstractWString,
    Array,
    BasicType,
    BoundedSequence,
    NamespacedType,
)

from biped_common.terminal_text import printable

_SEQUENCES = (list, tuple, array.array, np.ndarray)
_CUT = "..."
# libyaml takes a C integer; lines of text are not folded.
_ENDLESS = 2**31 - 1


@dataclass(frozen=True)
class Shown:
    """How much of a message is shown."""

    length: int | None = None
    """Longer strings, bytes and arrays are cut here; None cuts nothing."""
    arrays: bool = True
    """Whether the elements of arrays are shown, or their type and number only."""
    strings: bool = True
    """Whether strings are shown, or their length only."""


EVERYTHING = Shown()


def to_plain(
    message: Any, shown: Shown = EVERYTHING, *, octets: bool = False
) -> dict[str, Any]:
    """Return a message as dictionaries, lists, numbers and strings.

    Args:
        message: any.
        shown: how much of it.
        octets: as bytes; else as the characters of their numbers, as in the original.
    """
    return {
        name: _plain(getattr(message, name), shown, kind, octets)
        for name, kind in fields_of(message)
    }


def to_yaml(message: Any, shown: Shown = EVERYTHING, flow_style: bool = False) -> str:
    """Return a message as YAML, with a line's end."""
    return plain_to_yaml(to_plain(message, shown), flow_style)


def plain_to_yaml(plain: dict[str, Any], flow_style: bool = False) -> str:
    """Return what `to_plain` returned, perhaps changed, as YAML."""
    text = _dump(plain, yaml.CSafeDumper, flow_style)
    if "\\" in text:
        # libyaml is twenty times as quick, but escapes what is beyond 16 bits.
        text = _dump(plain, yaml.SafeDumper, flow_style)
    if printable(text, layout=True) != text:
        # YAML's own escapes, so that it is read as what it was. Some of what libyaml
        # writes as it is are ends of lines to a reader.
        text = _dump(plain, yaml.CSafeDumper, flow_style, allow_unicode=False)
    return text


def to_csv(message: Any, shown: Shown = EVERYTHING) -> str:
    """Return the values of all fields, nested ones too, separated by commas."""
    return _joined(to_plain(message, shown, octets=True))


def to_json(value: Any) -> str:
    """Return a message, or a field of one, as indented JSON.

    A string that holds JSON, as this project's do, is shown as what it says. JSON has
    no numbers for nan and the infinities; they are written as strings.
    """
    if hasattr(value, "get_fields_and_field_types"):
        plain: Any = to_plain(value)
        names = list(plain)
        if names == ["data"] and isinstance(plain["data"], str):
            plain = _decoded(plain["data"], otherwise=plain)
    elif isinstance(value, str):
        plain = _decoded(value, otherwise=value)
    else:
        plain = _plain(value, EVERYTHING, None, octets=False)
    text = _json(plain)
    # JSON's own escapes where some are needed.
    return text if printable(text, layout=True) == text else _json(plain, ascii=True)


def fields_of(message: Any) -> list[tuple[str, Any]]:
    """Return names and kinds (of rosidl_parser) of a message's fields, in order."""
    names = message.get_fields_and_field_types()
    return list(zip(names, message.SLOT_TYPES, strict=True))


def type_name(kind: Any) -> str:
    """Return the name of a field's or an element's type, as IDL has it."""
    if isinstance(kind, BasicType):
        return str(kind.typename)
    if isinstance(kind, AbstractString):
        return "string"
    if isinstance(kind, AbstractWString):
        return "wstring"
    if isinstance(kind, NamespacedType):
        return "/".join(kind.namespaced_name())
    return "unknown"


def _dump(
    plain: dict[str, Any], dumper: Any, flow_style: bool, allow_unicode: bool = True
) -> str:
    text: str = yaml.dump(
        plain,
        Dumper=dumper,
        sort_keys=False,
        allow_unicode=allow_unicode,
        width=_ENDLESS,
        default_flow_style=flow_style,
    )
    return text


def _json(plain: Any, *, ascii: bool = False) -> str:
    return json.dumps(_finite(plain), indent=2, ensure_ascii=ascii, allow_nan=False)


def _plain(value: Any, shown: Shown, kind: Any, octets: bool) -> Any:
    if isinstance(value, bool | int | float):
        return value
    if isinstance(value, str):
        return (
            _cut(value, shown) if shown.strings else f"<string length: <{len(value)}>>"
        )
    if isinstance(value, bytes):
        return _cut(value if octets else value.decode("latin-1"), shown)
    if isinstance(value, _SEQUENCES):
        if kind is not None and not shown.arrays:
            return _abbreviated(value, kind)
        if isinstance(value, array.array | np.ndarray):
            value = value.tolist()
        elements = [
            _plain(element, shown, None, octets) for element in value[: shown.length]
        ]
        return elements + [_CUT] * (len(value) > len(elements))
    return to_plain(value, shown, octets=octets)


def _joined(plain: Any) -> str:
    if isinstance(plain, dict):
        plain = list(plain.values())
    if not isinstance(plain, list):
        return str(plain)
    # Empty values in front leave no comma: the original's habit, which scripts know.
    text = ""
    for part in map(_joined, plain):
        text = f"{text},{part}" if text else part
    return text


def _cut(value: Any, shown: Shown) -> Any:
    if shown.length is None or len(value) <= shown.length:
        return value
    return value[: shown.length] + (_CUT if isinstance(value, str) else _CUT.encode())


def _abbreviated(value: Any, kind: Any) -> str:
    element = type_name(kind.value_type)
    if isinstance(kind, Array):
        return f"<array type: {element}[{kind.size}]>"
    bound = f"[{kind.maximum_size}]" if isinstance(kind, BoundedSequence) else ""
    return f"<sequence type: {element}{bound}, length: {len(value)}>"


def _decoded(text: str, otherwise: Any) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return otherwise


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(element) for key, element in value.items()}
    if isinstance(value, list):
        return [_finite(element) for element in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value
