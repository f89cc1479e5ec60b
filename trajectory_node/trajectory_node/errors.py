"""Errors of the trajectory package."""

from __future__ import annotations

from biped_common.errors import BipedError


class TrajectoryError(BipedError, ValueError):
    """Base of this package's errors."""


class InfeasibleGaitError(TrajectoryError):
    """The gait asks for something the robot cannot do; the message says what."""
