"""Errors of the simulation package."""

from __future__ import annotations

from biped_common.errors import BipedError


class SimulationError(BipedError):
    """Base of this package's errors."""


class EngineMissingError(SimulationError):
    """A physics engine is not installed."""


class WorldClosedError(SimulationError):
    """The world was used after it had been closed."""


class SnapshotError(SimulationError):
    """A snapshot belongs to another world, or was released."""
