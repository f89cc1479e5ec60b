"""Penalty rules and penalty states (Sections 2 and 3.4): who is one, and since when.

A sub-rule is a penalty sub-rule of a type once it was chosen in at least N0 episodes
and failed in more than the fraction lambda of them. A state is a penalty state when
all alternatives of some component are penalty sub-rules of any type.
"""

from __future__ import annotations

from typing import Any

from numba import boolean, float64, int64, njit, void
from numpy.typing import NDArray

from learner_node.xol.array_types import (
    COUNTS,
    INDICES,
    PENALTY_COUNTS,
    PENALTY_WEIGHTS,
    QUEUED_ALTERNATIVES,
    QUEUED_LIVE,
    WEIGHTS,
)

# Machine code kept on disk is renewed when its own file changes, not when a file that
# it calls into does: compiled functions here call only others of their own file.


@njit(
    boolean(int64, PENALTY_COUNTS, COUNTS, int64, float64, INDICES, COUNTS), cache=True
)
def judge_state(
    k: int,
    failures: NDArray[Any],
    selections: NDArray[Any],
    minimum_selections: int,
    failure_threshold: float,
    sizes: NDArray[Any],
    avoided: NDArray[Any],
) -> bool:
    """Judge all sub-rules of state k; return whether it is a penalty state.

    Args:
        k: the state.
        failures: (capacity, Np, I, J) counter of the rule table.
        selections: (capacity, I, J) counter of the rule table.
        minimum_selections: N0.
        failure_threshold: lambda.
        sizes: (I,) alternatives of each component.
        avoided: (capacity, I, J) filled at k with the number of penalty types, from
            the highest priority on, that a sub-rule avoids. The set Abar_i(l) of
            Section 3.5 holds the sub-rules that avoid at least l.
    """
    n_penalties, components, _ = failures.shape[1:]
    penalty_state = False
    for i in range(components):
        exhausted = True
        for j in range(sizes[i]):
            n = selections[k, i, j]
            first = n_penalties
            if n >= minimum_selections:
                for penalty in range(n_penalties):
                    if failures[k, penalty, i, j] > failure_threshold * n:
                        first = penalty
                        break
            avoided[k, i, j] = first
            if first == n_penalties:
                exhausted = False
        if exhausted:
            penalty_state = True
    return penalty_state


@njit(boolean(int64, INDICES, int64, COUNTS, COUNTS, PENALTY_COUNTS, int64), cache=True)
def count_selection(
    k: int,
    chosen: NDArray[Any],
    episode: int,
    selections: NDArray[Any],
    last_episode: NDArray[Any],
    failures: NDArray[Any],
    selection_memory: int,
) -> bool:
    """Count the chosen sub-rules, once per episode each; return whether any was new.

    Where `selection_memory` is not 0, a sub-rule that was selected so often has its
    selections and failures halved first: what it led to long ago, with other rules
    behind it, must not outvote what it leads to now.
    """
    changed = False
    for i in range(chosen.shape[0]):
        j = chosen[i]
        if last_episode[k, i, j] != episode:
            last_episode[k, i, j] = episode
            if 0 < selection_memory <= selections[k, i, j]:
                selections[k, i, j] //= 2
                for penalty in range(failures.shape[1]):
                    failures[k, penalty, i, j] //= 2
            selections[k, i, j] += 1
            changed = True
    return changed


@njit(
    void(
        int64,
        float64,
        int64,
        int64,
        int64,
        INDICES,
        QUEUED_ALTERNATIVES,
        QUEUED_LIVE,
        WEIGHTS,
        PENALTY_WEIGHTS,
    ),
    cache=True,
)
def add_penalty(
    penalty: int,
    value: float,
    newest: int,
    oldest: int,
    head: int,
    states: NDArray[Any],
    alternatives: NDArray[Any],
    live: NDArray[Any],
    eligibility: NDArray[Any],
    p: NDArray[Any],
) -> None:
    """P <- P + pnlty E on the decisions of ages newest <= age < oldest (eq. (1)).

    The last decision has age 0. A sub-rule in the queue twice is updated once.
    """
    length = states.shape[0]
    for age in range(newest, oldest):
        place = (head - 1 - age) % length
        k = states[place]
        for i in range(live.shape[1]):
            if live[place, i]:
                j = alternatives[place, i]
                p[k, penalty, i, j] += value * eligibility[k, i, j]


@njit(
    void(
        int64,
        int64,
        int64,
        int64,
        int64,
        INDICES,
        QUEUED_ALTERNATIVES,
        PENALTY_COUNTS,
        PENALTY_COUNTS,
    ),
    cache=True,
)
def count_failures(
    penalty: int,
    newest: int,
    oldest: int,
    episode: int,
    head: int,
    states: NDArray[Any],
    alternatives: NDArray[Any],
    failures: NDArray[Any],
    last_failure: NDArray[Any],
) -> None:
    """Count a failure for decisions of newest <= age < oldest, once per episode."""
    length = states.shape[0]
    for age in range(newest, oldest):
        place = (head - 1 - age) % length
        k = states[place]
        for i in range(alternatives.shape[1]):
            j = alternatives[place, i]
            if last_failure[k, penalty, i, j] != episode:
                last_failure[k, penalty, i, j] = episode
                failures[k, penalty, i, j] += 1
