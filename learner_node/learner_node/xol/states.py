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
_BLOCK = 512
# Two centres of one grid cell differ by rounding only.
_SAME_CELL_SQUARED_DISTANCE = 1e-6


@njit(
    "Tuple((int64, float64))(int64, float64[::1], int64[::1], float64[:, ::1], int64)",
    cache=True,
)
def nearest_state(
    group: int,
    point: NDArray[Any],
    state_groups: NDArray[Any],
    state_centers: NDArray[Any],
    count: int,
) -> tuple[int, float]:
    """Return (index, squared distance) of the nearest state of the same group.

    Looks at all of them: a few microseconds for thousands, since centres are stored by
    column and distances are added up in blocks that the processor does in parallel.

    Args:
        group: number of the combination of discrete inputs.
        point: (n_continuous,) continuous inputs in units of their radii.
        state_groups: (capacity,) groups of the states.
        state_centers: (n_continuous, capacity) centres in units of the radii.
        count: how many states there are.
    """
    best = -1
    best_squared = math.inf
    squared = np.empty(_BLOCK)
    for start in range(0, count, _BLOCK):
        n = min(_BLOCK, count - start)
        squared[:n] = 0.0
        for c in range(point.shape[0]):
            x = point[c]
            column = state_centers[c, start : start + n]
            for k in range(n):
                difference = column[k] - x
                squared[k] += difference * difference
        groups = state_groups[start : start + n]
        for k in range(n):
            if squared[k] < best_squared and groups[k] == group:
                best_squared = squared[k]
                best = start + k
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
        self.life = np.zeros(_FIRST_CAPACITY, dtype=np.int64)
        self._discrete = np.zeros((_FIRST_CAPACITY, n_discrete))
        self._columns = np.zeros((n_continuous, _FIRST_CAPACITY))
        self._groups = np.zeros(_FIRST_CAPACITY, dtype=np.int64)
        self._group_of: dict[bytes, int] = {}

    @property
    def discrete(self) -> NDArray[np.float64]:
        """(count, n_discrete) discrete inputs of the states."""
        return self._discrete[: self.count]

    @property
    def centers(self) -> NDArray[np.float64]:
        """(count, n_continuous) centres in units of the radii."""
        return self._columns[:, : self.count].T

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
        # One representation per number: whole numbers are floats, -0.0 is 0.0.
        inputs = np.asarray(inputs, dtype=np.float64) + 0.0
        discrete = inputs[: self.n_discrete]
        point = inputs[self.n_discrete :] / self._radii
        if not self._gaussian:
            point = np.rint(point)
        k, squared = nearest_state(
            self._group_of.get(discrete.tobytes(), NO_STATE),
            point,
            self._groups,
            self._columns,
            self.count,
        )
        if create:
            if squared > self._reach_squared:
                k = self._append(discrete, point)
            self.life[k] = self.settings.life_episodes
        return int(k)

    def replace(
        self,
        discrete: NDArray[np.float64],
        centers: NDArray[np.float64],
        life: NDArray[np.int64],
    ) -> None:
        """Take over other states, all of them.

        Args:
            discrete: (count, n_discrete) discrete inputs.
            centers: (count, n_continuous) centres in units of the radii.
            life: (count,) episodes left.
        """
        self.count = 0
        for row, center in zip(discrete, centers, strict=True):
            self._append(row, center)
        self.life[: self.count] = life

    def reserve(self, capacity: int) -> None:
        """Make room for at least `capacity` states."""
        while self.capacity < capacity:
            self.life = doubled(self.life)
            self._groups = doubled(self._groups)
            self._discrete = doubled(self._discrete)
            self._columns = doubled(self._columns.T).T.copy()

    def bytes_per_state(self) -> int:
        """Return the memory of one state."""
        arrays = (self.life, self._groups, self._discrete, self._columns)
        return sum(array.nbytes for array in arrays) // self.capacity

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
        self.life[:n] = self.life[remaining]
        self._groups[:n] = self._groups[remaining]
        self._discrete[:n] = self._discrete[remaining]
        self._columns[:, :n] = self._columns[:, remaining]
        self.count = n
        return remaining

    def _append(self, discrete: NDArray[np.float64], point: NDArray[np.float64]) -> int:
        self.reserve(self.count + 1)
        k = self.count
        key = discrete.tobytes()
        self._groups[k] = self._group_of.setdefault(key, len(self._group_of))
        self._discrete[k] = discrete
        self._columns[:, k] = point
        self.count += 1
        return k


def doubled(array: NDArray[Any]) -> NDArray[Any]:
    """Return a copy with twice the rows, the new ones zero."""
    return np.concatenate([array, np.zeros_like(array)])
