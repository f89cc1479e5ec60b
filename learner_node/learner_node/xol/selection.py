"""Action selection (Section 3.5): roulette, greedy, or ranking by penalty.

All three fill `chosen` (I,) with one alternative per component, for state k of the rule
table. `avoided` says how many penalty types a sub-rule avoids (see `judge_state`),
`sizes` (I,) how many alternatives a component has.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import float64, int64, njit, void
from numpy.typing import NDArray

from learner_node.xol.array_types import (
    COUNTS,
    DRAWS,
    INDICES,
    PENALTY_WEIGHTS,
    WEIGHTS,
)


@njit(void(int64, DRAWS, WEIGHTS, COUNTS, int64, float64, INDICES), cache=True)
def choose_roulette(
    k: int,
    draws: NDArray[Any],
    q: NDArray[Any],
    avoided: NDArray[Any],
    n_penalties: int,
    base_weight: float,
    chosen: NDArray[Any],
) -> None:
    """Choose among non-penalty sub-rules with probability ~ Q + base weight.

    `draws` (I,) are uniform random numbers in [0, 1). For states that are neither
    fixed nor penalty states, so that every component has a candidate.
    """
    for i in range(chosen.shape[0]):
        total = 0.0
        for j in range(q.shape[2]):
            if avoided[k, i, j] == n_penalties:
                total += q[k, i, j] + base_weight
        mark = draws[i] * total
        for j in range(q.shape[2]):
            if avoided[k, i, j] == n_penalties:
                # The last candidate stands where rounding leaves the mark beyond it.
                chosen[i] = j
                mark -= q[k, i, j] + base_weight
                if mark < 0.0:
                    break


@njit(void(int64, WEIGHTS, PENALTY_WEIGHTS, COUNTS, INDICES, INDICES), cache=True)
def choose_greedy(
    k: int,
    q: NDArray[Any],
    p: NDArray[Any],
    avoided: NDArray[Any],
    sizes: NDArray[Any],
    chosen: NDArray[Any],
) -> None:
    """Choose the largest Q among the sub-rules that avoid the most penalties.

    Ties go to the smaller summed P, then to the alternative nearest the middle.
    """
    for i in range(chosen.shape[0]):
        middle = 0.5 * (sizes[i] - 1)
        best = (-1.0, 0.0, 0.0, 0.0)
        for j in range(sizes[i]):
            candidate = (
                float(avoided[k, i, j]),
                q[k, i, j],
                -p[k, :, i, j].sum(),
                -abs(j - middle),
            )
            if candidate > best:
                best = candidate
                chosen[i] = j


@njit(void(int64, DRAWS, PENALTY_WEIGHTS, COUNTS, INDICES, INDICES), cache=True)
def choose_ranked(
    k: int,
    draws: NDArray[Any],
    p: NDArray[Any],
    avoided: NDArray[Any],
    sizes: NDArray[Any],
    chosen: NDArray[Any],
) -> None:
    """Choose in a penalty state by rank of the summed P, smallest first.

    Per component, the candidates are the last non-empty Abar_i(l); with none left
    even for the highest priority, all alternatives are equally likely. The candidate
    of rank r among n is taken with probability 2 (n - r + 1) / (n (n + 1)).
    """
    for i in range(chosen.shape[0]):
        most = avoided[k, i].max()
        if most == 0:
            chosen[i] = min(int(draws[i] * sizes[i]), sizes[i] - 1)
            continue
        candidates = np.flatnonzero(avoided[k, i] == most)
        penalty = p[k, :, i, :].sum(axis=0)[candidates]
        # Mergesort is stable: equal penalties keep the order of the alternatives.
        ranked = candidates[np.argsort(penalty, kind="mergesort")]
        n = len(ranked)
        mark = draws[i] * (n * (n + 1) // 2)
        for place in range(n):
            chosen[i] = ranked[place]
            mark -= n - place
            if mark < 0.0:
                break
