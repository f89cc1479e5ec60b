"""Errors of the simulation package."""

from __future__ import annotations

from biped_common.errors import BipedError
from msgs_json.end_cause import EndCause


class SimulationError(BipedError):
    """Base of this package's errors."""


class EngineMissingError(SimulationError):
    """A physics engine is not installed."""


class WorldClosedError(SimulationError):
    """The world was used after it had been closed."""


class SnapshotError(SimulationError):
    """A snapshot belongs to another world, or was released."""


class PlantStoppedError(SimulationError):
    """A plant cannot go on; the walk ends by its cause."""

    def __init__(self, cause: EndCause) -> None:
        """Say why."""
        super().__init__(f"the plant stopped: {cause}")
        self.cause = cause
