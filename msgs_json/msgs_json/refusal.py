"""A message that was understood but must not be acted on."""

from __future__ import annotations


class RefusedMessageError(ValueError):
    """Stale, duplicated, out of range or not meant for now; the text says which."""
