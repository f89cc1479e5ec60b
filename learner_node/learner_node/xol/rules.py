"""Rules and sub-rules: the weights Q, P and the counters behind penalty decisions.

Every table is NB x Nm x Na (Section 3.4). Undecomposed rules, NB x Na^Nm, are the same
code with one component whose alternatives are all the joint actions.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from learner_node.problem import ActionSpace
from learner_node.states import doubled

_FIRST_CAPACITY = 64


class RuleTable:
    """Per state and sub-rule: weights, and counts of selections and failures.

    Arrays (capacity rows, the first `NB` in use; I, J = table_shape):
        q: (., I, J) weight Q of profit sharing.
        p: (., Np, I, J) penalty weight P per penalty type.
        failures: (., Np, I, J) episodes in which the sub-rule led to the penalty.
        selections: (., I, J) episodes in which the sub-rule was chosen.
        last_episode: (., I, J) number of the last episode in which it was chosen.
        last_failure: (., Np, I, J) last episode in which a failure was counted.
        rewards: (.,) TUC, rewards since the state was last released.
        fixed: (.,) state is in fixed mode.
        penalty_state: (.,) all alternatives of some component are penalty rules.
        avoided: (., I, J) penalty types that the sub-rule avoids, see `judge_state`;
            -1 where a component has no such alternative.
    """

    # What a checkpoint holds, and what moves when states are forgotten.
    ARRAYS = (
        "q",
        "p",
        "failures",
        "selections",
        "last_episode",
        "last_failure",
        "rewards",
        "fixed",
        "penalty_state",
        "avoided",
    )

    def __init__(self, space: ActionSpace, n_penalties: int) -> None:
        """Start with all weights and counters zero (Section 3.6, step 1)."""
        shape = space.table_shape
        rows = _FIRST_CAPACITY
        self.space = space
        self.sizes = np.array(space.sizes, dtype=np.int64)
        self.n_penalties = n_penalties
        self.q = np.zeros((rows, *shape))
        self.p = np.zeros((rows, n_penalties, *shape))
        self.failures = np.zeros((rows, n_penalties, *shape), dtype=np.int64)
        self.selections = np.zeros((rows, *shape), dtype=np.int64)
        self.last_episode = np.zeros((rows, *shape), dtype=np.int64)
        self.last_failure = np.zeros((rows, n_penalties, *shape), dtype=np.int64)
        self.rewards = np.zeros(rows, dtype=np.int64)
        self.fixed = np.zeros(rows, dtype=np.bool_)
        self.penalty_state = np.zeros(rows, dtype=np.bool_)
        exists = np.arange(shape[1]) < self.sizes[:, None]
        self._unjudged = np.where(exists, n_penalties, -1)
        self.avoided = np.tile(self._unjudged, (rows, 1, 1))

    def tables(self) -> Iterator[NDArray[Any]]:
        """Yield the arrays, in the order of ARRAYS."""
        return (getattr(self, name) for name in self.ARRAYS)

    def grow(self, capacity: int) -> None:
        """Make room for at least `capacity` states."""
        while len(self.rewards) < capacity:
            rows = len(self.rewards)
            for name in self.ARRAYS:
                setattr(self, name, doubled(getattr(self, name)))
            self.clear_from(rows)

    def keep(self, remaining: NDArray[np.int64]) -> None:
        """Keep the given states, in order; the rest loses all it had learned."""
        n = len(remaining)
        for name in self.ARRAYS:
            array = getattr(self, name)
            array[:n] = array[remaining]
        self.clear_from(n)

    def clear_from(self, row: int) -> None:
        """Make the rows from `row` on as if never used."""
        for name in self.ARRAYS:
            getattr(self, name)[row:] = self._unjudged if name == "avoided" else 0
