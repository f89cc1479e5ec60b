"""Fill a message from YAML: `{header: auto, position: [0.1, 0.2]}`.

Only what is named is set. Whatever does not fit is refused, with the path of the field
and what it takes: an unknown name, a fraction for an integer, a text for a truth value,
a number out of range, a list that is too long. Nothing is guessed.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from rosidl_parser.definition import (
    AbstractGenericString,
    AbstractNestedType,
    Array,
    BoundedSequence,
    NamespacedType,
)

from biped_common.plain_yaml import YamlError, read_yaml
from ros2_verbs.errors import VerbError
from ros2_verbs.messages.text import fields_of, type_name
from ros2_verbs.options import completed

Stamp = Callable[[Any], None]
"""Sets a field of the message to a builtin_interfaces.msg.Time."""

_TIME = "builtin_interfaces/msg/Time"
_HEADER = "std_msgs/msg/Header"
_FLOATS = ("float", "double", "long double")


def add_values_arguments(
    parser: argparse.ArgumentParser, what: str, completer: Callable[..., list[str]]
) -> None:
    """Add the values, and --stdin to read them from there.

    Args:
        parser: of the verb.
        what: said of the values, in its help.
        completer: of argcomplete, offers all values to be edited.
    """
    values = parser.add_mutually_exclusive_group()
    completed(
        values.add_argument("values", nargs="?", default="{}", help=what), completer
    )
    values.add_argument(
        "--stdin", action="store_true", help="read the values from standard input"
    )


def given_values(args: argparse.Namespace) -> dict[str, Any]:
    """Return the values that the arguments name.

    Raises:
        VerbError: they are no YAML, or not a dictionary.
    """
    return values_of(sys.stdin.read() if args.stdin else args.values)


def values_of(text: str) -> dict[str, Any]:
    """Return the values that a YAML text holds.

    Raises:
        VerbError: it is no YAML, or not a dictionary.
    """
    try:
        values = read_yaml(text)
    except YamlError as error:
        raise VerbError(f"The passed value is no valid YAML: {error}") from None
    if values is None:
        return {}
    if not isinstance(values, dict):
        raise VerbError("The passed value needs to be a dictionary in YAML format")
    return values


def fill(message: Any, values: dict[str, Any]) -> list[Stamp]:
    """Set fields of a message.

    Args:
        message: any.
        values: by field name; nested messages are dictionaries. A header may be `auto`
            and a time `now`.

    Returns:
        What sets the fields that are `auto` or `now`, for every publication anew.

    Raises:
        VerbError: a value does not fit; the message may be filled in part.
    """
    stamps: list[Stamp] = []
    _fill(message, values, "", stamps)
    return stamps


def _fill(message: Any, values: Any, path: str, stamps: list[Stamp]) -> None:
    kinds = dict(fields_of(message))
    if not isinstance(values, dict):
        raise _misfit(path, values, f"a dictionary of {', '.join(kinds)}")
    for name, value in values.items():
        here = f"{path}.{name}" if path else str(name)
        if name not in kinds:
            known = ", ".join(kinds) or "no fields"
            raise VerbError(
                f"Failed to populate field: '{type(message).__name__}' object has no "
                f"attribute '{here}', it has {known}"
            )
        setattr(message, name, _value(kinds[name], value, here, stamps))


def _value(kind: Any, given: Any, path: str, stamps: list[Stamp]) -> Any:
    if isinstance(kind, AbstractNestedType):
        return _elements(kind, given, path, stamps)
    if isinstance(kind, NamespacedType):
        return _message(kind, given, path, stamps)
    if isinstance(kind, AbstractGenericString):
        if not isinstance(given, list | dict) and given is not None:
            return str(given)
        raise _misfit(path, given, "a string")
    return _number(type_name(kind), given, path)


def _elements(kind: Any, given: Any, path: str, stamps: list[Stamp]) -> list[Any]:
    size = ""
    if isinstance(kind, Array):
        size = f" of length {kind.size}"
    elif isinstance(kind, BoundedSequence):
        size = f" of at most {kind.maximum_size} elements"
    expected = f"a list{size} of {type_name(kind.value_type)}"
    if (
        not isinstance(given, list)
        or (isinstance(kind, Array) and len(given) != kind.size)
        or (isinstance(kind, BoundedSequence) and len(given) > kind.maximum_size)
    ):
        raise _misfit(path, given, expected)
    return [
        _value(kind.value_type, element, f"{path}[{index}]", stamps)
        for index, element in enumerate(given)
    ]


def _message(kind: Any, given: Any, path: str, stamps: list[Stamp]) -> Any:
    *package, name = kind.namespaced_name()
    message = getattr(importlib.import_module(".".join(package)), name)()
    full_name = type_name(kind)
    if full_name == _HEADER and given == "auto":
        stamps.append(lambda now: setattr(message, "stamp", now))
    elif full_name == _TIME and given == "now":
        stamps.append(lambda now: _copy_time(message, now))
    else:
        _fill(message, given, path, stamps)
    return message


def _copy_time(time: Any, now: Any) -> None:
    time.sec, time.nanosec = now.sec, now.nanosec


def _number(kind: str, given: Any, path: str) -> Any:
    if kind == "boolean":
        if given in (True, False):
            return bool(given)
        raise _misfit(path, given, "true or false")
    if kind == "octet":
        return _octet(given, path)
    number = _parsed(given)
    if kind in _FLOATS:
        if number is not None:
            return float(number)
        raise _misfit(path, given, "a number")
    # Jazzy's messages do not check for themselves.
    bounds = np.iinfo(kind)
    least, most = int(bounds.min), int(bounds.max)
    if number is not None and number == number // 1 and least <= number <= most:
        return int(number)
    raise _misfit(path, given, f"a whole number from {least} to {most} ({kind})")


def _octet(given: Any, path: str) -> bytes:
    # Either the number, or the character as which octets are printed.
    if isinstance(given, int) and 0 <= given <= 255:
        return bytes([given])
    if isinstance(given, str) and len(given) == 1 and ord(given) <= 255:
        return given.encode("latin-1")
    raise _misfit(path, given, "a number from 0 to 255 or one character")


def _parsed(given: Any) -> int | float | None:
    # YAML takes 1e5, without a point, for text.
    if isinstance(given, str):
        try:
            return float(given)
        except ValueError:
            return None
    is_number = isinstance(given, int | float) and not isinstance(given, bool)
    return given if is_number else None


def _misfit(path: str, given: Any, expected: str) -> VerbError:
    text = repr(given)
    short = text if len(text) <= 60 else text[:57] + "..."
    where = f"{path}: " if path else ""
    return VerbError(
        f"Failed to populate field: {where}got {short}, expected {expected}"
    )
