"""Types of the learner's arrays, for functions that are compiled when imported.

With their types given, functions are compiled once for all when they are imported, and
not in the middle of a first walk that others wait for.
"""

from __future__ import annotations

from numba import boolean, float64, int64

INDICES = int64[::1]
"""States in the queue, or one alternative per component."""
DRAWS = float64[::1]
"""A uniform random number per component."""
QUEUED_ALTERNATIVES = int64[:, ::1]
QUEUED_LIVE = boolean[:, ::1]
"""By place in the queue and component."""
WEIGHTS = float64[:, :, ::1]
"""Q or E, by state, component and alternative."""
COUNTS = int64[:, :, ::1]
"""By state, component and alternative."""
PENALTY_WEIGHTS = float64[:, :, :, ::1]
"""P, by state, type of penalty, component and alternative."""
PENALTY_COUNTS = int64[:, :, :, ::1]
"""By state, type of penalty, component and alternative."""
