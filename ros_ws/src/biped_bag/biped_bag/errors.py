"""Errors of bags."""

from __future__ import annotations

from biped_common.errors import BipedError


class BagError(BipedError):
    """A bag cannot be written or read; the text says which, where and why."""
