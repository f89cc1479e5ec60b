"""What a robot that keeps its own time is sent: each trajectory begins with the last.

A trajectory is the way of the joints through the coming control ticks, look-ahead
included. The robot joins it some ticks after the reading that it answers, and must meet
no step there: a micrometre, taken in one tick of 2 ms, is 0.25 m/s^2, and 12 mm of ZMP.
So it leaves what was sent before only when the robot has surely got it, and gradually.
Until then it makes no difference when it comes.
"""

from __future__ import annotations

import numpy as np

from biped_common.timing import control_ticks
from sim_node.physics import Array

AS_BEFORE_TICKS = control_ticks(0.04)
"""From a reading until what answers it changes anything."""
LEAST_LOOK_AHEAD_TICKS = control_ticks(0.1)
"""What leaves a change 30 ms and more to come about, where segments are on time."""
GOES_ON_TICKS = control_ticks(0.02)
"""Until joints that are to stay do: the newest reading is of the past."""
STAYS_TICKS = control_ticks(0.1)
"""A controller refuses a trajectory that has ended when it comes."""


class SentTrajectory:
    """Joint positions, tick by tick from after the tick that they were sent at."""

    def __init__(self) -> None:
        """Nothing was sent."""
        self._tick = 0
        self._positions: Array = np.empty((0, 0))

    def forget(self) -> None:
        """Begin anew: the robot stands, or ticks are counted from elsewhere."""
        self._positions = self._positions[:0]

    def next(self, tick: int, positions: Array) -> Array:
        """Return (ticks, 12) positions to send now; they are taken to be sent [rad].

        Args:
            tick: at which the robot is.
            positions: (ticks, 12) that are wanted from after this tick on [rad].
        """
        known = self._positions[tick - self._tick :][: len(positions)]
        n = len(known)
        if n > AS_BEFORE_TICKS:
            left = np.arange(1, n + 1) - AS_BEFORE_TICKS
            s = left.clip(min=0) / (n - AS_BEFORE_TICKS)
            share = (s**2 * (3.0 - 2.0 * s))[:, None]
            way = known + share * (positions[:n] - known)
            positions = np.vstack([way, positions[n:]])
        self._tick, self._positions = tick, positions
        return positions

    def asked(self, tick: int) -> Array | None:
        """Return (12,) positions that the joints are asked to be at after a tick [rad].

        None before anything was sent. Behind its end, a trajectory stays where it led.

        Args:
            tick: not before the newest trajectory was sent.
        """
        positions = self._positions
        if len(positions) == 0:
            return None
        after: Array = positions[max(0, min(tick - self._tick, len(positions)) - 1)]
        return after

    def stay(self, tick: int) -> Array | None:
        """Return (ticks, 12) positions that come to rest at once, None if at rest.

        Args:
            tick: of the newest reading.
        """
        positions = self._positions
        if len(positions) == 0:
            return None
        now = tick - self._tick
        last = min(now + GOES_ON_TICKS, len(positions)) - 1
        self.forget()
        staying: Array = positions[(now + np.arange(STAYS_TICKS)).clip(0, max(last, 0))]
        return staying
