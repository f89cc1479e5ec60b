"""Errors of the verbs."""

from __future__ import annotations


class VerbError(RuntimeError):
    """A verb cannot do what it was asked; the text is one line for the user."""
