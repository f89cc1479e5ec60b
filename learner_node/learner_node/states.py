"""Discrete states from mixed continuous and discrete inputs by basis functions.

A state is a Gaussian bump centred at an input that no existing bump covered; discrete
inputs partition the space (Section 2; the basis of [12, 18] is not given in the paper).
The uniform grid of [18] is the alternative.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from biped_common.settings import Settings, setting
from learner_node.memory import Arrays
from learner_node.problem import Problem

NO_STATE = -1
_FIRST_CAPACITY = 64
_BLOCK = 512
# Two centres of one grid cell differ by rounding only.
_SAME_CELL_SQUARED_DISTANCE = 1e-6


@dataclass(frozen=True)
class StateSettings(Settings):
    """How continuous inputs become discrete states (Section 2, [12, 18])."""

    basis: str = setting(
        "gaussian",
        "",
        "shape of the states: Gaussian bumps made where needed, or a uniform grid",
        choices=("gaussian", "uniform"),
    )
    activation_threshold: float = setting(
        math.exp(-0.5),
        "",
        "a new Gaussian state is made where no existing one is this active",
        above=0.0,
        upper=1.0,
    )
    life_episodes: int = setting(
        100, "episodes", "an unrewarded state unvisited this long is forgotten", lower=1
    )


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

    def __init__(self, settings: StateSettings, problem: Problem) -> None:
        """Start without any state.

        Args:
            settings: kind, threshold and life span.
            problem: number of discrete inputs, and widths of the continuous ones.
        """
        self.settings = settings
        self.n_discrete, n_continuous = problem.n_discrete, len(problem.radii)
        self._radii = np.array(problem.radii, dtype=np.float64)
        # phi = exp(-d^2/2) falls below the threshold outside this distance.
        self._gaussian = settings.basis == "gaussian"
        self._reach_squared = (
            -2.0 * math.log(settings.activation_threshold)
            if self._gaussian
            else _SAME_CELL_SQUARED_DISTANCE
        )
        self.count = 0
        self.life = np.zeros(_FIRST_CAPACITY, dtype=np.int64)
        self._discrete = np.zeros((_FIRST_CAPACITY, self.n_discrete))
        self._columns = np.zeros((n_continuous, _FIRST_CAPACITY))
        self._groups = np.zeros(_FIRST_CAPACITY, dtype=np.int64)
        self._group_of: dict[bytes, int] = {}
        self._marked_life = self.life[:0].copy()

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

    def memory(self) -> Arrays:
        """Return views of the states, for a learner's memory."""
        return {
            "state_discrete": self.discrete,
            "state_centers": self.centers,
            "state_life": self.life[: self.count],
        }

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over the states of a memory that fits, all of them."""
        self.count = 0
        for discrete, center in zip(
            memory["state_discrete"], memory["state_centers"], strict=True
        ):
            self._append(discrete, center)
        self.life[: self.count] = memory["state_life"]

    def mark(self) -> None:
        """Remember which states there are, and for how long, until the next mark."""
        self._marked_life = self.life[: self.count].copy()

    def rewind(self) -> None:
        """Drop the states made since the mark; let the others live as long as then.

        Not after `age`, which forgets states.
        """
        self.count = len(self._marked_life)
        self.life[: self.count] = self._marked_life

    def _reserve(self, capacity: int) -> None:
        while self.capacity < capacity:
            self.life = doubled(self.life)
            self._groups = doubled(self._groups)
            self._discrete = doubled(self._discrete)
            self._columns = doubled(self._columns.T).T.copy()

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
        self._reserve(self.count + 1)
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
