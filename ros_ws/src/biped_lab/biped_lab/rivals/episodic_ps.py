"""Profit sharing (Section 3.1, [10]): the whole episode shares the reward.

    w(s_i, a_i) <- w(s_i, a_i) + f(i),   f(i) = r gamma^(T - i)   for i = 1 ... T

An episode in the sense of Section 2 ends with the reward, or with a penalty; then it
shares nothing. There are neither penalty rules nor fixed states.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import Settings, setting
from biped_lab.learner_contestant import learner_entry
from learner_node.learner import Push
from learner_node.problem import Problem
from learner_node.states import StateSettings
from learner_node.tabular import TabularLearner


@dataclass(frozen=True)
class EpisodicSettings(Settings):
    """Constants of episodic profit sharing."""

    discount: float = setting(
        0.98, "per decision", "gamma of the evaluation function", above=0.0, upper=1.0
    )
    base_weight: float = setting(
        100.0, "", "added to every weight in the roulette, as in XoL", above=0.0
    )


class EpisodicProfitSharing(TabularLearner):
    """Remembers all decisions of an episode; rewards them together."""

    def __init__(
        self,
        settings: EpisodicSettings,
        states: StateSettings,
        problem: Problem,
        rng: np.random.Generator,
    ) -> None:
        """Start with all weights zero.

        Args:
            settings: gamma, base weight.
            states: how inputs become states.
            problem: inputs, actions and penalties.
            rng: source of every random choice.
        """
        super().__init__(states, problem, rng)
        self.discount, self.base_weight = settings.discount, settings.base_weight
        self.series: list[tuple[int, NDArray[np.int64]]] = []
        """State and (I,) chosen sub-rules, decision by decision."""

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state; nothing was chosen yet."""
        super().begin_episode(inputs)
        self.series.clear()

    def choose(self) -> NDArray[np.int64]:
        """Choose by the roulette, and remember it."""
        chosen = self.roulette(self.state, self.base_weight)
        self.series.append((self.state, chosen))
        return self.problem.space.alternatives_of(chosen)

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Share the reward among all decisions since the last one."""
        share = value
        for k, chosen in reversed(self.series):
            self.q[k, self.components, chosen] += share
            share *= self.discount
        self.series.clear()

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Share nothing: the series has led to a failure."""
        super().penalise(penalty)
        self.series.clear()


ENTRY = learner_entry(
    __name__,
    EpisodicSettings,
    lambda options, settings, problem, rng: EpisodicProfitSharing(
        options, settings.states, problem, rng
    ),
)
