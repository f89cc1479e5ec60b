"""What tabular learners have in common: states, a table Q, the seam's chores.

States are those of XoL; they are selected from as in Section 3.5, by the very functions
of XoL. What a learner learns, and when, stands in its own file: `q_lambda.py` here, the
other rivals in `biped_lab/rivals`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from learner_node.journal import RowJournal
from learner_node.learner import Push
from learner_node.memory import Arrays, check_memory, count_of_states
from learner_node.problem import Problem
from learner_node.states import NO_STATE, BasisStates, StateSettings, doubled
from learner_node.xol import selection

_DOES_NOT_EXIST, _LAST_RESORT, _CANDIDATE = -1, 0, 1


class TabularLearner(ABC):
    """A `learner_node.learner.Learner` but for what it learns.

    An episode may change the rows of the states that it visits, and no others: by that
    it can be given up.
    """

    TABLES: ClassVar[tuple[str, ...]] = ("q",)
    """Attributes that are tables, (capacity, I, J): what is known of each sub-rule."""

    def __init__(
        self, states: StateSettings, problem: Problem, rng: np.random.Generator
    ) -> None:
        """Start with no state.

        Args:
            states: how inputs become states.
            problem: inputs, actions and penalties.
            rng: source of every random choice.
        """
        self.problem = problem
        self.rng = rng
        self.states = BasisStates(states, problem)
        shape = problem.space.table_shape
        self.sizes = np.array(problem.space.sizes, dtype=np.int64)
        self.exists = np.arange(shape[1]) < self.sizes[:, None]
        """(I, J) the component has that many alternatives."""
        self.q = np.zeros((self.states.capacity, *shape))
        """(capacity, I, J) weight or value of every sub-rule."""
        self.components = np.arange(shape[0])
        """(I,) 0, 1, ...: beside (I,) alternatives they make an index of a row."""
        self.episode = 0
        self.state = NO_STATE
        self._journal = RowJournal()
        self._p = np.zeros((1, 1, *shape))  # no P here: penalties break no ties

    # -- one episode -------------------------------------------------------------

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state."""
        self.episode += 1
        self.states.mark()
        self._journal.begin()
        self.state = self._locate(inputs)

    @abstractmethod
    def choose(self) -> NDArray[np.int64]:
        """Return the (Nm,) index of the chosen alternative per component."""

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Move to the next state."""
        self.state = self._locate(inputs)

    @abstractmethod
    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Take a reward for what was chosen."""

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Take no notice."""
        self.problem.check_penalty(penalty)

    def finish_subtask(self) -> None:  # noqa: B027 - it may well do nothing
        """Fix nothing."""

    def finish_episode(self) -> None:
        """Forget states that promise nothing and were not visited for a life span."""
        self.state = NO_STATE
        promising = (self.q[: self.states.count] > 0.0).any(axis=(1, 2))
        remaining = self.states.age(kept=np.asarray(promising))
        if remaining is not None:
            self._keep(remaining)

    def give_up_episode(self) -> None:
        """Become what it was before the episode began, but for the random numbers."""
        self._journal.undo(self._tables())
        self.states.rewind()
        self.episode -= 1
        self.state = NO_STATE

    # -- selection (Section 3.5) -------------------------------------------------

    def refused(self, k: int) -> NDArray[np.bool_] | None:
        """Return which (I, J) sub-rules of state k are a last resort; None: none is."""
        return None

    def roulette(self, k: int, base_weight: float) -> NDArray[np.int64]:
        """Choose (I,) sub-rules of state k with probability ~ Q + base weight.

        A component of which all alternatives are refused chooses among all.
        """
        candidates = self._candidates(k)
        exhausted = (candidates != _CANDIDATE).all(axis=1)
        candidates[exhausted[:, None] & self.exists] = _CANDIDATE
        chosen = np.zeros(len(self.sizes), dtype=np.int64)
        draws = self.rng.random(len(chosen))
        selection.choose_roulette(
            0, draws, self.q[k : k + 1], candidates[None], 1, base_weight, chosen
        )
        return chosen

    def best(self, k: int) -> NDArray[np.int64]:
        """Return the (I,) sub-rules of state k of the largest Q.

        Ties go to the alternative nearest the middle: the smallest correction.
        """
        chosen = np.zeros(len(self.sizes), dtype=np.int64)
        selection.choose_greedy(
            0, self.q[k : k + 1], self._p, self._candidates(k)[None], self.sizes, chosen
        )
        return chosen

    def greedy(self, inputs: NDArray[np.float64]) -> NDArray[np.int64] | None:
        """Return the best known action, None where no state is; learn nothing."""
        k = self.states.find(inputs, create=False)
        return None if k == NO_STATE else self.problem.space.alternatives_of(
            self.best(k)
        )  # fmt: skip

    def _candidates(self, k: int) -> NDArray[np.int64]:
        """Return the (I, J) preference classes that XoL's selection goes by."""
        candidates = np.where(self.exists, _CANDIDATE, _DOES_NOT_EXIST)
        refused = self.refused(k)
        if refused is not None:
            candidates[refused & self.exists] = _LAST_RESORT
        return candidates

    # -- memory ------------------------------------------------------------------

    def figures(self) -> dict[str, float]:
        """Return the number of states, and of those that promise a reward."""
        q = self.q[: self.states.count]
        return {
            "basis_states": self.states.count,
            "promising_states": int((q.max(axis=2) > 0.0).all(axis=1).sum()),
        }

    def memory(self) -> Arrays:
        """Return a copy of all that was learned, as arrays; between episodes."""
        return {name: array.copy() for name, array in self._arrays().items()}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `memory` returned.

        Raises:
            ValueError: an array is missing or its shape belongs to another problem.
        """
        count = count_of_states(memory)
        check_memory(memory, self._arrays(), count)
        self.states.restore(memory)
        self._make_room()
        for name, table in zip(self.TABLES, self._tables(), strict=True):
            table[:count] = memory[name]
            table[count:] = 0
        self.episode = int(memory["episode"])
        self.state = NO_STATE

    def _arrays(self) -> Arrays:
        arrays = {
            **self.states.memory(),
            "episode": np.array(self.episode, dtype=np.int64),
        }
        for name, table in zip(self.TABLES, self._tables(), strict=True):
            arrays[name] = table[: self.states.count]
        return arrays

    def _tables(self) -> Iterator[NDArray[Any]]:
        return (getattr(self, name) for name in self.TABLES)

    def _keep(self, remaining: NDArray[np.int64]) -> None:
        """Keep the given states, in order; the rest loses all it had learned."""
        n = len(remaining)
        for table in self._tables():
            table[:n] = table[remaining]
            table[n:] = 0

    def _locate(self, inputs: NDArray[np.float64]) -> int:
        k = self.states.find(inputs, create=True)
        self._make_room()
        self._journal.visit(k, self._tables())
        return k

    def _make_room(self) -> None:
        while len(self.q) < self.states.capacity:
            for name in self.TABLES:
                setattr(self, name, doubled(getattr(self, name)))
