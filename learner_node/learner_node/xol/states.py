"""Discrete states from mixed continuous and discrete inputs by basis functions.

A state is a Gaussian bump centred at an input that no existing bump covered; discrete
inputs partition the space (Section 2; the basis of [12, 18] is not given in the paper).
The uniform grid of [18] is the alternative.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from learner_node.xol.settings import StateSettings

NO_STATE = -1
_FIRST_CAPACITY = 64
# Two centres of one grid cell differ by rounding only.
_SAME_CELL_SQUARED_DISTANCE = 1e-6


@njit(cache=True)
def nearest_state(
    discrete: NDArray[Any],
    point: NDArray[Any],
    state_discrete: NDArray[Any],
    state_centers: NDArray[Any],
    count: int,
) -> tuple[int, float]:
    """Return (index, squared distance) of the nearest state of the same partition.

    Args:
        discrete: (n_discrete,) discrete inputs, compared exactly.
        point: (n_continuous,) continuous inputs in units of their radii.
        state_discrete: (capacity, n_discrete) discrete inputs of the states.
        state_centers: (capacity, n_continuous) centres in units of the radii.
        count: how many rows are in use.
    """
    best = -1
    best_squared = math.inf
    n_discrete = discrete.shape[0]
    n_continuous = point.shape[0]
    for k in range(count):
        same = True
        for d in range(n_discrete):
            if state_discrete[k, d] != discrete[d]:
                same = False
                break
        if not same:
            continue
        squared = 0.0
        for c in range(n_continuous):
            difference = state_centers[k, c] - point[c]
            squared += difference * difference
        if squared < best_squared:
            best_squared = squared
            best = k
    return best, best_squared


class BasisStates:
    """The set of discrete states S = {s_k}, growing where inputs are new."""

    def __init__(
        self, settings: StateSettings, n_discrete: int, n_continuous: int
    ) -> None:
        """Start without any state.

        Args:
            settings: kind, radii, threshold and life span.
            n_discrete: number of leading inputs that are discrete.
            n_continuous: number of inputs after them; one radius each.
        """
        self.settings = settings
        self.n_discrete = n_discrete
        self.n_continuous = n_continuous
        self._radii = np.asarray(settings.radii, dtype=np.float64)
        if self._radii.shape != (n_continuous,):
            raise ValueError(
                f"radii: {len(self._radii)} given, one per continuous input needed, "
                f"that is {n_continuous}"
            )
        # phi = exp(-d^2/2) falls below the threshold outside this distance.
        self._gaussian = settings.basis == "gaussian"
        self._reach_squared = (
            -2.0 * math.log(settings.activation_threshold)
            if self._gaussian
            else _SAME_CELL_SQUARED_DISTANCE
        )
        self.count = 0
        self.discrete = np.zeros((_FIRST_CAPACITY, n_discrete))
        self.centers = np.zeros((_FIRST_CAPACITY, n_continuous))
        self.life = np.zeros(_FIRST_CAPACITY, dtype=np.int64)

    @property
    def capacity(self) -> int:
        """Rows allocated; arrays indexed by state have at least this many."""
        return len(self.life)

    def find(self, inputs: NDArray[np.float64], create: bool) -> int:
        """Return the most active state, made on the spot where none is active.

        Args:
            inputs: (n_discrete + n_continuous,) sensory input.
            create: make a state where none is active; without it the nearest state
                of the same partition is returned, or NO_STATE if there is none.
        """
        discrete = inputs[: self.n_discrete]
        point = inputs[self.n_discrete :] / self._radii
        if not self._gaussian:
            point = np.rint(point)
        k, squared = nearest_state(
            discrete, point, self.discrete, self.centers, self.count
        )
        if create:
            if squared > self._reach_squared:
                k = self._append(discrete, point)
            self.life[k] = self.settings.life_episodes
        return int(k)

    def reserve(self, capacity: int) -> None:
        """Make room for at least `capacity` states."""
        while self.capacity < capacity:
            self.discrete = doubled(self.discrete)
            self.centers = doubled(self.centers)
            self.life = doubled(self.life)

    def age(self, kept: NDArray[np.bool_]) -> NDArray[np.int64] | None:
        """Let every state live one episode less and forget those whose life is over.

        Args:
            kept: (count,) states that are never forgotten (rewarded ones).

        Returns:
            The old indices of the states that remain, in order, or None if all do.
        """
        life = self.life[: self.count]
        life -= 1
        alive = (life >= 0) | kept
        if alive.all():
            return None
        remaining = np.flatnonzero(alive)
        n = len(remaining)
        for array in (self.discrete, self.centers, self.life):
            array[:n] = array[remaining]
        self.count = n
        return remaining

    def _append(self, discrete: NDArray[np.float64], point: NDArray[np.float64]) -> int:
        self.reserve(self.count + 1)
        k = self.count
        self.discrete[k] = discrete
        self.centers[k] = point
        self.count += 1
        return k


def doubled(array: NDArray[Any]) -> NDArray[Any]:
    """Return a copy with twice the rows, the new ones zero."""
    return np.concatenate([array, np.zeros_like(array)])
