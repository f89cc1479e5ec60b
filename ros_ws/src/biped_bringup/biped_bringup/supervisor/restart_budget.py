"""How often a node may be restarted, and how long to wait before each time.

As systemd does it: five failures within ten seconds are one too many. On a slow machine
a node can take longer than that to fail five times; so are five starts in a row after
which the node was never ready.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field


@dataclass
class RestartBudget:
    """Counts the failures of one node; the caller brings the time."""

    limit: int = 5
    window_s: float = 10.0
    first_delay_s: float = 0.1
    longest_delay_s: float = 5.0
    _failures: deque[float] = field(default_factory=deque)
    _was_ready: bool = True

    def ready(self) -> None:
        """Take note that the node has come up."""
        self._was_ready = True

    def failed(self, now_s: float) -> float | None:
        """Count a failure; return how long to wait, None if the budget is used up."""
        self._failures.append(now_s)
        while self._was_ready and now_s - self._failures[0] > self.window_s:
            self._failures.popleft()
        self._was_ready = False
        recent = len(self._failures)
        if recent >= self.limit:
            return None
        return min(self.first_delay_s * 2.0 ** (recent - 1), self.longest_delay_s)
