"""Directed blame: failures judge alternatives by which way they push. Not in the paper.

A penalty says that something was wrong, and the paper blames the last decisions for it,
whatever they were. Where a failure has a direction and the alternatives of a component
have an order, it says more: what pushes the same way at least as hard as that which
failed would have failed, too. All alternatives of a component are judged by that, the
chosen one and those that were not; those that push less count as tried without failing.
So one failure forbids a whole side, failures on the other side take that back, and what
fails neither way is never blamed. It does not halve: failures of both sides weigh
against each other, and in one state by itself the right alternative is found no sooner
than without a direction. What is gained is that many states learn from each failure.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray


def directed(
    push: NDArray[np.float64],
    states: NDArray[np.int64],
    alternatives: NDArray[np.int64],
    sizes: NDArray[np.int64],
    share: float,
) -> Iterator[tuple[int, int, NDArray[np.bool_]]]:
    """Yield each state and component that pushed, and which alternatives are no better.

    Args:
        push: (ages, I) of one alternative more; see `Learner.penalise`.
        states: (ages,) of the decisions, newest first.
        alternatives: (ages, I) that they chose.
        sizes: (I,) alternatives of each component.
        share: of the strongest push in sum, from which on a state is judged.

    Yields:
        State, component, and (sizes[i],) what pushes at least as hard as the mildest
        alternative that the state chose.
    """
    visited, visits = np.unique(states, return_inverse=True)
    pushed = np.zeros((len(visited), push.shape[1]))
    np.add.at(pushed, visits, push)
    strength = np.abs(pushed)
    strongest = strength.max(initial=0.0)
    for row, i in np.argwhere((strength > 0.0) & (strength >= share * strongest)):
        chosen = alternatives[visits == row, i]
        order = np.arange(sizes[i])
        upwards = pushed[row, i] > 0.0
        no_better = order >= chosen.min() if upwards else order <= chosen.max()
        yield int(visited[row]), int(i), no_better


def count_trials(
    selections: NDArray[Any],
    last_episode: NDArray[Any],
    failures: NDArray[Any],
    episode: int,
    selection_memory: int,
) -> None:
    """Count all alternatives of a component as tried, once per episode each.

    Args:
        selections: (J,) of one component of a state, changed in place.
        last_episode: (J,) in which they were counted last, changed in place.
        failures: (Np, J) halved in place where selections are.
        episode: the present one.
        selection_memory: as in `count_selection`.
    """
    new = last_episode != episode
    if selection_memory > 0:
        old = new & (selections >= selection_memory)
        selections[old] //= 2
        failures[:, old] //= 2
    selections[new] += 1
    last_episode[new] = episode
