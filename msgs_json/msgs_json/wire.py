"""JSON on the wire: strict both ways.

Every payload is one typed struct with a `version`. What is unknown, missing, not finite
or of the wrong type or length is refused, naming the field; nothing is guessed.
"""

from __future__ import annotations

from typing import TypeVar

import msgspec

Payload = TypeVar("Payload", bound=msgspec.Struct)


class MalformedMessageError(ValueError):
    """A message cannot be understood; the text says which field, and why."""


class _Versioned(msgspec.Struct):
    version: int


def encode(payload: msgspec.Struct) -> str:
    """Return the JSON of a payload; numbers come back to the last bit."""
    return msgspec.json.encode(payload).decode()


def decode(kind: type[Payload], text: str | bytes) -> Payload:
    """Return the payload of a JSON text.

    Raises:
        MalformedMessageError: not JSON, or not a payload of this kind and version.
    """
    try:
        # A tag that is missing altogether would be taken for the right one.
        msgspec.json.decode(text, type=_Versioned)
        return msgspec.json.decode(text, type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError) as error:
        raise MalformedMessageError(f"{kind.__name__}: {error}") from None
