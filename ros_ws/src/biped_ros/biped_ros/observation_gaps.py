"""Observations that were given out but never came."""

from __future__ import annotations

from biped_common.timing import TICKS_PER_LEARNING_TICK
from msgs_json.observation import Observation


class ObservationGaps:
    """Knows from the count of control ticks what lies between two observations."""

    def __init__(self) -> None:
        """Start with the first observation that comes, wherever in a walk it is."""
        self._last: Observation | None = None

    def before(self, observation: Observation) -> int:
        """Return how many observations of this walk are missing before this one.

        One that is older than the last counts for nothing.
        """
        last = self._last
        if last is None or last.simulation != observation.simulation:
            self._last = observation
            return 0
        if observation.clock_ticks <= last.clock_ticks:
            return 0
        self._last = observation
        if observation.episode == last.episode:
            since = observation.control_tick - last.control_tick
            return max(0, -(-since // TICKS_PER_LEARNING_TICK) - 1)
        # The one at control tick 0 is missing, too.
        return -(-observation.control_tick // TICKS_PER_LEARNING_TICK)
