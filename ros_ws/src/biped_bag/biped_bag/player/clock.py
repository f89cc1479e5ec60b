"""When a recorded message is due: from log time to the player's own time.

Due times are absolute: they are reckoned from where playing last began or went on, so
that a message that comes late delays none after it. All times are whole nanoseconds.
"""

from __future__ import annotations

import math

FLAT_OUT = math.inf
"""The rate at which every message is due at once."""


class PlaybackClock:
    """Play, pause, go on and step; the caller brings the present time."""

    def __init__(
        self, log_ns: int, rate: float, now_ns: int, *, paused: bool = False
    ) -> None:
        """Begin to play.

        Args:
            log_ns: log time with which playing begins.
            rate: recorded nanoseconds per nanosecond, above 0; FLAT_OUT for no waiting.
            now_ns: the present, of a clock that never goes back.
            paused: begin paused.
        """
        self.rate = rate
        self._log_ns = log_ns
        self._since_ns = now_ns
        self._steps = 0
        self.paused = paused

    def due_ns(self, log_ns: int) -> int | None:
        """Return when a message is due, None while that is unknown: paused."""
        if self.paused:
            return self._since_ns if self._steps else None
        return self._since_ns + round((log_ns - self._log_ns) / self.rate)

    def achieved_rate(self, log_ns: int, now_ns: int) -> float:
        """Return the rate at which it has come to a log time since it last went on."""
        return (log_ns - self._log_ns) / max(1, now_ns - self._since_ns)

    def took(self, log_ns: int) -> None:
        """Take note that a message is being published; while paused, that is a step."""
        if self.paused:
            self._steps -= 1
            self._log_ns = max(self._log_ns, log_ns)

    def pause(self, now_ns: int) -> bool:
        """Stop; return whether it was playing."""
        if self.paused:
            return False
        if self.rate != FLAT_OUT:
            self._log_ns += round((now_ns - self._since_ns) * self.rate)
        self._since_ns = now_ns
        self.paused = True
        return True

    def resume(self, now_ns: int) -> bool:
        """Go on where it stopped; return whether it was paused."""
        if not self.paused:
            return False
        self._since_ns = now_ns
        self._steps = 0
        self.paused = False
        return True

    def step(self) -> bool:
        """Let one message pass; return whether it was paused."""
        if self.paused:
            self._steps += 1
        return self.paused

    def set_rate(self, rate: float, now_ns: int) -> None:
        """Play on at another rate, from where it is now."""
        if not self.paused:
            self._log_ns += round((now_ns - self._since_ns) * self.rate)
            self._since_ns = now_ns
        self.rate = rate

    def restart(self, log_ns: int, now_ns: int) -> None:
        """Begin again at a log time, playing or paused as before."""
        self._log_ns = log_ns
        self._since_ns = now_ns
