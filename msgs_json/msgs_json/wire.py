"""JSON on the wire: strict both ways.

Every payload is one typed struct with a `version`. What is unknown, missing, not finite
or of the wrong type or length is refused, naming the field; nothing is guessed. The
same contract for programs in other languages: the JSON Schema files in `schemas/`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any, TypeVar

import msgspec

from biped_common.errors import BipedError
from msgs_json.bounds import MOST_CHARACTERS

Payload = TypeVar("Payload", bound=msgspec.Struct)


class RefusedMessageError(BipedError, ValueError):
    """A message was understood but must not be acted on; the text says why.

    It is stale, duplicated, out of range or not meant for now.
    """


class MalformedMessageError(BipedError, ValueError):
    """A message cannot be understood; the text says which field, and why."""


class NotFiniteError(BipedError, ValueError):
    """A payload holds a number that JSON does not know; the text says where."""


def encode(payload: msgspec.Struct) -> str:
    """Return the JSON of a payload; numbers come back to the last bit.

    Raises:
        NotFiniteError: a number is NaN or infinite.
    """
    # msgspec would write null.
    for place in _not_finite(payload, "$"):
        raise NotFiniteError(f"{type(payload).__name__}: not a finite number: {place}")
    return msgspec.json.encode(payload).decode()


def decode(kind: type[Payload], text: str | bytes) -> Payload:
    """Return the payload of a JSON text.

    Raises:
        MalformedMessageError: not JSON, or not a payload of this kind and version.
    """
    if len(text) > MOST_CHARACTERS:
        raise MalformedMessageError(
            f"{kind.__name__}: {len(text)} characters, {MOST_CHARACTERS} at most"
        )
    try:
        # msgspec takes a version that is missing altogether for the right one.
        msgspec.json.decode(text, type=_versions_of(kind))
        return msgspec.json.decode(text, type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise MalformedMessageError(f"{kind.__name__}: {error}") from None
    except RecursionError:
        raise MalformedMessageError(f"{kind.__name__}: nested too deep") from None


def _not_finite(value: object, place: str) -> Iterator[str]:
    """Yield the places of numbers that are not finite."""
    if isinstance(value, float):
        if not math.isfinite(value):
            yield place
    elif isinstance(value, msgspec.Struct):
        for name in value.__struct_fields__:
            yield from _not_finite(getattr(value, name), f"{place}.{name}")
    elif isinstance(value, tuple):
        for i, element in enumerate(value):
            yield from _not_finite(element, f"{place}[{i}]")
    elif isinstance(value, dict):
        for name, element in value.items():
            yield from _not_finite(element, f"{place}.{name}")


@cache
def _versions_of(kind: type[msgspec.Struct]) -> type[msgspec.Struct]:
    """Return a struct of nothing but the versions that a payload must have."""
    fields: list[tuple[str, Any]] = [("version", int)]
    for field in msgspec.structs.fields(kind):
        nested = field.type
        if isinstance(nested, type) and issubclass(nested, msgspec.Struct):
            fields.append((field.name, _versions_of(nested)))
    return msgspec.defstruct(f"{kind.__name__}Versions", fields)
