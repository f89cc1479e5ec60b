"""Errors of bags."""

from __future__ import annotations


class BagError(Exception):
    """A bag cannot be written or read; the text says which, where and why."""
