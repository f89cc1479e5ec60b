"""Watkins's Q(lambda), the first rival: values instead of profit sharing.

On the same states, sub-rules, rewards and penalties as XoL: one table of values per
action component (Section 3.4), a reward is +rwd, a penalty -pnlty. There are neither
penalty rules nor fixed states: chance never ends, but for a greedy walk.

    Q <- Q + alpha (r + gamma max Q' - Q) E       for every sub-rule of a component
    E <- gamma lambda E                           and 0 after an exploratory choice
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import Settings, setting
from learner_node.journal import RowJournal
from learner_node.learner import Push
from learner_node.memory import Arrays, check_memory, count_of_states
from learner_node.problem import Problem
from learner_node.states import NO_STATE, BasisStates, StateSettings, doubled


@dataclass(frozen=True)
class QLambdaSettings(Settings):
    """Constants of Q(lambda)."""

    learning_rate: float = setting(0.2, "", "alpha", above=0.0, upper=1.0)
    discount: float = setting(0.98, "per decision", "gamma", above=0.0, upper=1.0)
    trace_decay: float = setting(
        0.95, "per decision", "lambda, beside gamma", lower=0.0, upper=1.0
    )
    exploration: float = setting(
        0.01,
        "",
        "epsilon: share of choices, per component, that are left to chance",
        lower=0.0,
        upper=1.0,
    )


class QLambda:
    """Answers the calls of `learner_node.learner.Learner`."""

    def __init__(
        self,
        settings: QLambdaSettings,
        states: StateSettings,
        problem: Problem,
        rng: np.random.Generator,
    ) -> None:
        """Start with all values zero.

        Args:
            settings: alpha, gamma, lambda, epsilon.
            states: how inputs become states.
            problem: inputs, actions and penalties.
            rng: source of every random choice.
        """
        self.settings = settings
        self.problem = problem
        self.rng = rng
        self.states = BasisStates(states, problem)
        shape = problem.space.table_shape
        self._components = np.arange(shape[0])
        self._sizes = np.array(problem.space.sizes)
        # The middle first, so that of equal values the smallest correction is taken.
        self._preference = -1e-9 * np.abs(
            np.arange(shape[1]) - 0.5 * (self._sizes[:, None] - 1)
        )
        self._preference[np.arange(shape[1]) >= self._sizes[:, None]] = -np.inf
        rows = self.states.capacity
        self.q = np.zeros((rows, *shape))
        """(capacity, I, J) value of every sub-rule."""
        self.traces = np.zeros_like(self.q)
        """(capacity, I, J) E."""
        self.episode = 0
        self.state = NO_STATE
        self._chosen = np.zeros(shape[0], dtype=np.int64)
        self._earned: float | None = None
        """What was earned since the last choice; None: nothing was said."""
        self._journal = RowJournal()

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state; nothing is owed to earlier choices."""
        self.episode += 1
        self.traces[: self.states.count] = 0.0
        self._earned = None
        self.states.mark()
        self._journal.begin()
        self.state = self._locate(inputs)

    def choose(self) -> NDArray[np.int64]:
        """Choose the best, or with probability epsilon anything, per component."""
        k, i = self.state, self._components
        explores = self.rng.random(len(i)) < self.settings.exploration
        anything = (self.rng.random(len(i)) * self._sizes).astype(np.int64)
        self._chosen = np.where(explores, anything, self._best(k))
        # What came before an exploratory choice is not answerable for what follows.
        self.traces[: self.states.count, explores] = 0.0
        self.traces[k, i, self._chosen] = 1.0
        return self._chosen.copy()

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Move to the next state and learn from the move."""
        following = self._locate(inputs)
        value = (self.q[following] + self._preference).max(axis=1)
        self._learn(self.settings.discount * value)
        self.state = following

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Earn rwd; successes are not counted here."""
        self._earned = (self._earned or 0.0) + value

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Earn -pnlty."""
        self.problem.check_penalty(penalty)
        self._earned = (self._earned or 0.0) - self.problem.penalty_values[penalty]

    def finish_subtask(self) -> None:
        """Nothing is fixed here."""

    def finish_episode(self) -> None:
        """Learn from the last move, if it earned anything; forget unused states."""
        if self._earned is not None:
            self._learn(np.zeros(len(self._components)))
        self.traces[: self.states.count] = 0.0
        self.state = NO_STATE
        known = np.any(self.q[: self.states.count] > 0.0, axis=(1, 2))
        remaining = self.states.age(kept=np.asarray(known))
        if remaining is not None:
            n = len(remaining)
            self.q[:n] = self.q[remaining]
            self.q[n:] = 0.0

    def give_up_episode(self) -> None:
        """Become what it was before the episode began, but for the random numbers."""
        self._journal.undo((self.q,))
        self.traces[: self.states.count] = 0.0
        self.states.rewind()
        self.episode -= 1
        self.state = NO_STATE

    def greedy(self, inputs: NDArray[np.float64]) -> NDArray[np.int64] | None:
        """Return the best known action, None where no state is; learn nothing."""
        k = self.states.find(inputs, create=False)
        return None if k == NO_STATE else self._best(k)

    def figures(self) -> dict[str, float]:
        """Return the number of states, and of those that promise a reward."""
        q = self.q[: self.states.count]
        return {
            "basis_states": self.states.count,
            "promising_states": int((q.max(axis=2) > 0.0).all(axis=1).sum()),
        }

    def memory(self) -> Arrays:
        """Return a copy of all that was learned, as arrays; between episodes."""
        arrays = {
            **self.states.memory(),
            "episode": np.array(self.episode, dtype=np.int64),
            "q": self.q[: self.states.count],
        }
        return {name: array.copy() for name, array in arrays.items()}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `memory` returned.

        Raises:
            ValueError: an array is missing or its shape belongs to another problem.
        """
        count = count_of_states(memory)
        check_memory(memory, self.memory(), count)
        self.states.restore(memory)
        self._make_room()
        self.q[:count] = memory["q"]
        self.q[count:] = 0.0
        self.traces[:] = 0.0
        self.episode = int(memory["episode"])
        self.state = NO_STATE

    def _best(self, k: int) -> NDArray[np.int64]:
        best: NDArray[np.int64] = (self.q[k] + self._preference).argmax(axis=1)
        return best

    def _learn(self, expected: NDArray[np.float64]) -> None:
        """Move the values towards what was earned and what is (I,) expected now."""
        settings, count = self.settings, self.states.count
        old = self.q[self.state, self._components, self._chosen]
        error = (self._earned or 0.0) + expected - old
        traces = self.traces[:count]
        self.q[:count] += settings.learning_rate * error[:, None] * traces
        traces *= settings.discount * settings.trace_decay
        self._earned = None

    def _locate(self, inputs: NDArray[np.float64]) -> int:
        k = self.states.find(inputs, create=True)
        self._make_room()
        self._journal.visit(k, (self.q,))
        return k

    def _make_room(self) -> None:
        while len(self.q) < self.states.capacity:
            self.q, self.traces = doubled(self.q), doubled(self.traces)
