"""Whether real time is kept, and what to do where it is not."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

from biped_common.timing import seconds
from sim_node.realtime import Punctuality

_KEPT = 0.9
"""Of the pace asked for, below which real time is not kept."""
_LOOKS = 5


class _Counts(NamedTuple):
    ticks: int
    lost_ns: int
    missed: int


class PaceWatch:
    """Looks at a robot's punctuality now and then, and judges the last few looks."""

    def __init__(self, punctuality: Punctuality) -> None:
        """Start with nothing seen.

        Args:
            punctuality: of the robot in real time.
        """
        self._punctuality = punctuality
        self._seen: deque[_Counts] = deque([_Counts(0, 0, 0)], maxlen=_LOOKS + 1)

    def look(self, factor: float) -> str | None:
        """Return what there is to say, None where real time is kept.

        Args:
            factor: simulated seconds per second that are asked for.
        """
        now = self._punctuality
        self._seen.append(_Counts(now.ticks, now.lost_ns, now.missed_deadlines))
        before, after = self._seen[0], self._seen[-1]
        walked_s = seconds(after.ticks - before.ticks)
        lost_s = (after.lost_ns - before.lost_ns) * 1e-9
        missed = after.missed - before.missed
        due_s = walked_s / factor + lost_s
        kept = walked_s / factor / due_s if due_s > 0.0 else 1.0
        if kept >= _KEPT and missed == 0:
            return None
        return (
            f"real time is not kept: {kept * factor:.2f} simulated s per s, "
            f"{factor:g} asked for, missed deadlines {after.missed}; walk in lockstep, "
            f"or slower with realtime_factor {factor / 2:g}"
        )
