"""The queue of recent decisions with its eligibility traces (Section 3.2).

The queue bounds both memory and work: a rule that leaves it has no eligibility, and a
sub-rule chosen again gives up its older place, so that it is updated once.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import float64, int64, njit, void
from numpy.typing import NDArray

from learner_node.states import doubled
from learner_node.xol.array_types import (
    COUNTS,
    INDICES,
    QUEUED_ALTERNATIVES,
    QUEUED_LIVE,
    WEIGHTS,
)

_FIRST_CAPACITY = 64
_NO_PLACE = -1


@njit(
    void(
        int64,
        INDICES,
        int64,
        INDICES,
        QUEUED_ALTERNATIVES,
        QUEUED_LIVE,
        COUNTS,
        WEIGHTS,
    ),
    cache=True,
)
def push_decision(
    state: int,
    chosen: NDArray[Any],
    head: int,
    states: NDArray[Any],
    alternatives: NDArray[Any],
    live: NDArray[Any],
    place: NDArray[Any],
    eligibility: NDArray[Any],
) -> None:
    """Overwrite the oldest place `head` with a decision: E <- E + 1 (2(c)ii, iii)."""
    oldest = states[head]
    for i in range(chosen.shape[0]):
        if live[head, i]:
            j = alternatives[head, i]
            eligibility[oldest, i, j] = 0.0
            place[oldest, i, j] = _NO_PLACE
    states[head] = state
    for i in range(chosen.shape[0]):
        j = chosen[i]
        older = place[state, i, j]
        if older != _NO_PLACE:
            live[older, i] = False
        alternatives[head, i] = j
        live[head, i] = True
        place[state, i, j] = head
        eligibility[state, i, j] += 1.0


@njit(void(float64, INDICES, QUEUED_ALTERNATIVES, QUEUED_LIVE, WEIGHTS), cache=True)
def decay_eligibility(
    discount: float,
    states: NDArray[Any],
    alternatives: NDArray[Any],
    live: NDArray[Any],
    eligibility: NDArray[Any],
) -> None:
    """E <- gamma E for every sub-rule in the queue (2(c)vii)."""
    for place in range(states.shape[0]):
        for i in range(live.shape[1]):
            if live[place, i]:
                eligibility[states[place], i, alternatives[place, i]] *= discount


class DecisionQueue:
    """The last decisions (state, chosen sub-rules), newest overwriting oldest.

    Attributes:
        states: (length,) state of each decision.
        alternatives: (length, I) chosen sub-rules.
        live: (length, I) the sub-rule was not chosen again since.
        eligibility: (capacity, I, J) E of every sub-rule; zero outside the queue.
        head: place of the next decision.
        filled: number of decisions held.
    """

    def __init__(self, length: int, table_shape: tuple[int, int]) -> None:
        """Start empty, with room for `length` decisions."""
        components, alternatives = table_shape
        self.length = length
        self.states = np.zeros(length, dtype=np.int64)
        self.alternatives = np.zeros((length, components), dtype=np.int64)
        self.live = np.zeros((length, components), dtype=np.bool_)
        self.eligibility = np.zeros((_FIRST_CAPACITY, components, alternatives))
        self._place = np.full(self.eligibility.shape, _NO_PLACE, dtype=np.int64)
        self.head = 0
        self.filled = 0

    def grow(self, capacity: int) -> None:
        """Make room for at least `capacity` states."""
        while len(self.eligibility) < capacity:
            rows = len(self.eligibility)
            self.eligibility = doubled(self.eligibility)
            self._place = doubled(self._place)
            self._place[rows:] = _NO_PLACE

    def clear(self) -> None:
        """Empty the queue and set all E = 0 (2(b))."""
        touched = self.states[: self.filled]
        self.eligibility[touched] = 0.0
        self._place[touched] = _NO_PLACE
        self.live[:] = False
        self.head = 0
        self.filled = 0

    def push(self, state: int, chosen: NDArray[np.int64]) -> None:
        """Add a decision and its eligibility."""
        push_decision(
            state,
            chosen,
            self.head,
            self.states,
            self.alternatives,
            self.live,
            self._place,
            self.eligibility,
        )
        self.head = (self.head + 1) % self.length
        self.filled = min(self.filled + 1, self.length)

    def decay(self, discount: float) -> None:
        """Discount the eligibility of all sub-rules in the queue."""
        decay_eligibility(
            discount, self.states, self.alternatives, self.live, self.eligibility
        )
