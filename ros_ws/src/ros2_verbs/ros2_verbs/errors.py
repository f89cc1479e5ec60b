"""Errors of the verbs."""

from __future__ import annotations

from biped_common.errors import BipedError


class VerbError(BipedError):
    """A verb cannot do what it was asked; the text is one line for the user."""
