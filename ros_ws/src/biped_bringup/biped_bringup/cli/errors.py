"""Errors of the command line."""

from __future__ import annotations


class CommandError(ValueError):
    """Options that do not go together, or a folder that cannot be used."""
