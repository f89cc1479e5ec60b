"""SARSA(lambda) with replacing traces: values of what is done, chance included.

Rummery and Niranjan (1994); replacing traces by Singh and Sutton (1996), in the form of
Sutton and Barto (1998), Section 7.8. One table of values per action component, a reward
is +rwd, a penalty -pnlty, as in `learner_node.q_lambda`.

    choose a' in s', epsilon-greedily
    delta  <- r + gamma Q(s', a') - Q(s, a)        Q(s', a') = 0 after the last one
    e(s, a) <- 1;  e(s, b) <- 0 for b other than a
    Q <- Q + alpha delta e;  e <- gamma lambda e   for all sub-rules of the component
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_lab.learner_contestant import learner_entry
from learner_node.learner import Push
from learner_node.problem import Problem
from learner_node.q_lambda import QLambdaSettings
from learner_node.states import StateSettings, doubled
from learner_node.tabular import TabularLearner


@dataclass(frozen=True)
class SarsaSettings(QLambdaSettings):
    """Constants of SARSA(lambda): those of Q(lambda)."""


class SarsaLambda(TabularLearner):
    """Learns from each move, once the choice after it is made."""

    def __init__(
        self,
        settings: SarsaSettings,
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
        self.traces = np.zeros_like(self.q)
        """(capacity, I, J) e of every sub-rule."""
        self._last: tuple[int, NDArray[np.int64]] | None = None
        """State and (I,) chosen sub-rules of the last decision."""
        self._earned: float | None = None
        """What was earned since; None: nothing was said."""

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state; nothing is owed to earlier choices."""
        super().begin_episode(inputs)
        self.traces[:] = 0.0
        self._last = self._earned = None

    def choose(self) -> NDArray[np.int64]:
        """Choose the best, or with probability epsilon anything, per component."""
        k, i = self.state, self.components
        explores = self.rng.random(len(i)) < self.settings.exploration
        anything = self.rng.integers(self.sizes)
        chosen = np.where(explores, anything, self.best(k))
        self._learn(self.settings.discount * self.q[k, i, chosen])
        while len(self.traces) < len(self.q):
            self.traces = doubled(self.traces)
        self.traces[k] = 0.0
        self.traces[k, i, chosen] = 1.0
        self._last = (k, chosen)
        return self.problem.space.alternatives_of(chosen)

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Earn rwd."""
        self._earned = (self._earned or 0.0) + value

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Earn -pnlty."""
        super().penalise(penalty)
        self._earned = (self._earned or 0.0) - self.problem.penalty_values[penalty]

    def finish_episode(self) -> None:
        """Learn from the last move, if it earned anything."""
        if self._earned is not None:
            self._learn(np.zeros(len(self.components)))
        super().finish_episode()

    def _learn(self, expected: NDArray[np.float64]) -> None:
        """Move the values towards what was earned and what is (I,) expected now."""
        if self._last is None:
            return
        k, chosen = self._last
        settings, rows = self.settings, len(self.traces)
        error = (self._earned or 0.0) + expected - self.q[k, self.components, chosen]
        self.q[:rows] += settings.learning_rate * error[:, None] * self.traces
        self.traces *= settings.discount * settings.trace_decay
        self._earned = None


ENTRY = learner_entry(
    __name__,
    SarsaSettings,
    lambda options, settings, problem, rng: SarsaLambda(
        options, settings.states, problem, rng
    ),
)
