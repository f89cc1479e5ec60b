"""Joins what the robot observed with what the learner answered into a segment.

Observation and correction of a learning tick come by different ways and in any order.
They belong together by the time of the simulation's clock that both carry.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from msgs_json.wire import RefusedMessageError
from trajectory_node.waist_reference import WaistReference


class SegmentMaker:
    """Follows one simulation at a time."""

    def __init__(self, reference: WaistReference, limit_m: float) -> None:
        """Wait for the start of a walk.

        Args:
            reference: makes the segments.
            limit_m: largest component of a correction that is accepted [m].
        """
        self._reference = reference
        self._limit_m = limit_m
        self._observation: Observation | None
        self._answered: bool
        self._early: tuple[int, NDArray[np.float64]] | None
        self.forget()

    def forget(self) -> None:
        """Forget what was observed, and wait for the start of a walk."""
        self._observation = None
        self._answered = True
        self._early = None

    def observe(self, observation: Observation) -> WaistSegment | None:
        """Take an observation; return the segment if its correction is here already.

        Raises:
            RefusedMessageError: the observation is old, or of a walk whose start was
                not seen, which cannot be continued.
        """
        last = self._observation
        if last is not None:
            anew = last.simulation != observation.simulation
            if not anew and observation.clock_ticks <= last.clock_ticks:
                raise RefusedMessageError(
                    f"observation of clock tick {observation.clock_ticks} comes after "
                    f"that of {last.clock_ticks}"
                )
            if anew:
                self._early = None
        self._observation = observation
        self._answered = observation.end_cause is not None
        if self._answered:
            return None
        if observation.control_tick == 0:
            self._reference.reset()
        elif observation.control_tick != self._reference.tick:
            self._answered = True
            raise RefusedMessageError(
                f"walk at control tick {observation.control_tick}, its reference is at "
                f"{self._reference.tick}: waiting for the next walk"
            )
        if self._early is not None:
            early, self._early = self._early, None
            return self.correct(*early)
        return None

    def correct(
        self, clock_ticks: int, correction_m: NDArray[np.float64]
    ) -> WaistSegment | None:
        """Take a correction; return the segment if its observation is here already.

        Args:
            clock_ticks: of the observation that it answers.
            correction_m: (2,) [m].

        Raises:
            RefusedMessageError: not finite, out of range, old, or answered before.
        """
        if not np.isfinite(correction_m).all():
            raise RefusedMessageError(f"correction {correction_m}: must be finite")
        if np.abs(correction_m).max() > self._limit_m:
            raise RefusedMessageError(
                f"correction {correction_m} m: must be within {self._limit_m} m"
            )
        observed = -1 if self._observation is None else self._observation.clock_ticks
        if clock_ticks > observed:
            self._early = (clock_ticks, correction_m)
            return None
        if clock_ticks < observed or self._answered:
            raise RefusedMessageError(
                f"correction for clock tick {clock_ticks}, which is over"
            )
        if self._reference.tick >= self._reference.ticks:
            raise RefusedMessageError(
                f"correction beyond the walk of {self._reference.ticks} ticks, "
                "which is over"
            )
        self._answered = True
        return self._reference.segment(correction_m)
