"""Errors raised by this package, one family: ``DescriptionError``."""

from biped_common.errors import BipedError


class DescriptionError(BipedError, ValueError):
    """Base of all errors of this package."""


class InvalidInputError(DescriptionError):
    """An array has the wrong shape, or an entry is NaN or infinite."""


class UnreachablePoseError(DescriptionError):
    """The distance from hip to ankle is outside what the leg can span."""


class JointLimitError(DescriptionError):
    """The pose asks a joint to go beyond its position limits."""
