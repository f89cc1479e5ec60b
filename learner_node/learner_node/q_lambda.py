"""Watkins's Q(lambda), the first rival: values instead of profit sharing.

On the same states, sub-rules, rewards and penalties as XoL: one table of values per
action component (Section 3.4), a reward is +rwd, a penalty -pnlty. There are neither
penalty rules nor fixed states: chance never ends, but for a greedy walk.

    Q <- Q + alpha (r + gamma max Q' - Q) E       for every sub-rule of a component
    E <- gamma lambda E                           and 0 after an exploratory choice
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import Settings, setting
from learner_node.learner import Push
from learner_node.problem import Problem
from learner_node.states import StateSettings, doubled
from learner_node.tabular import TabularLearner


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


class QLambda(TabularLearner):
    """Learns from each move, as if only the best were chosen from there on."""

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
        super().__init__(states, problem, rng)
        self.settings = settings
        # The middle first, so that of equal values the smallest correction is taken.
        self._preference = -1e-9 * np.abs(
            np.arange(self.exists.shape[1]) - 0.5 * (self.sizes[:, None] - 1)
        )
        self._preference[~self.exists] = -np.inf
        self.traces = np.zeros_like(self.q)
        """(capacity, I, J) E."""
        self._chosen = np.zeros(len(self.sizes), dtype=np.int64)
        self._earned: float | None = None
        """What was earned since the last choice; None: nothing was said."""

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state; nothing is owed to earlier choices."""
        super().begin_episode(inputs)
        self.traces[:] = 0.0
        self._earned = None

    def choose(self) -> NDArray[np.int64]:
        """Choose the best, or with probability epsilon anything, per component."""
        k, i = self.state, self.components
        explores = self.rng.random(len(i)) < self.settings.exploration
        anything = (self.rng.random(len(i)) * self.sizes).astype(np.int64)
        self._chosen = np.where(explores, anything, self.best(k))
        while len(self.traces) < len(self.q):
            self.traces = doubled(self.traces)
        # What came before an exploratory choice is not answerable for what follows.
        self.traces[: self.states.count, explores] = 0.0
        self.traces[k, i, self._chosen] = 1.0
        return self.problem.space.alternatives_of(self._chosen)

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Move to the next state and learn from the move."""
        former = self.state
        super().advance(inputs)
        value = (self.q[self.state] + self._preference).max(axis=1)
        self._learn(former, self.settings.discount * value)

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Earn rwd; successes are not counted here."""
        self._earned = (self._earned or 0.0) + value

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Earn -pnlty."""
        super().penalise(penalty)
        self._earned = (self._earned or 0.0) - self.problem.penalty_values[penalty]

    def finish_episode(self) -> None:
        """Learn from the last move, if it earned anything."""
        if self._earned is not None:
            self._learn(self.state, np.zeros(len(self.components)))
        super().finish_episode()

    def best(self, k: int) -> NDArray[np.int64]:
        """Return the (I,) sub-rules of state k of the largest Q."""
        best: NDArray[np.int64] = (self.q[k] + self._preference).argmax(axis=1)
        return best

    def _learn(self, k: int, expected: NDArray[np.float64]) -> None:
        """Move the values towards what was earned and what is (I,) expected now.

        Args:
            k: the state that the last choice was made in.
            expected: (I,) value of what follows, discounted.
        """
        settings, count = self.settings, self.states.count
        traces = self.traces[:count]  # without the state that was just made
        old = self.q[k, self.components, self._chosen]
        error = (self._earned or 0.0) + expected - old
        self.q[: len(traces)] += settings.learning_rate * error[:, None] * traces
        traces *= settings.discount * settings.trace_decay
        self._earned = None
