"""Online profit sharing (Section 3.2, [2]): a bounded queue shares the reward.

    c(s, a) <- c(s, a) + 1       when a rule is chosen and enters the queue
    w(s, a) <- w(s, a) + r c(s, a)   for the rules in the queue, on a reward
    c(s, a) <- gamma c(s, a)     every step; 0 for a rule that leaves the queue

There are neither penalty rules nor fixed states: what is left of XoL without its
Section 3.3 and without penalties. The queue is the same one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.settings import setting
from biped_lab.learner_contestant import learner_entry
from biped_lab.rivals.episodic_ps import EpisodicSettings
from learner_node.problem import Problem
from learner_node.states import StateSettings
from learner_node.tabular import TabularLearner
from learner_node.xol.queue import DecisionQueue


@dataclass(frozen=True)
class OnlineSettings(EpisodicSettings):
    """Constants of online profit sharing: gamma is that of the trace."""

    queue_length: int = setting(
        150,
        "decisions",
        "decisions that a reward reaches back",
        lower=1,
        upper=100_000,
    )


class OnlineProfitSharing(TabularLearner):
    """Rewards what is still in the queue."""

    def __init__(
        self,
        settings: OnlineSettings,
        states: StateSettings,
        problem: Problem,
        rng: np.random.Generator,
    ) -> None:
        """Start with all weights zero and an empty queue.

        Args:
            settings: gamma, length of the queue, base weight.
            states: how inputs become states.
            problem: inputs, actions and penalties.
            rng: source of every random choice.
        """
        super().__init__(states, problem, rng)
        self.settings = settings
        self.queue = DecisionQueue(settings.queue_length, problem.space.table_shape)

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Take the initial state and empty the queue."""
        self.queue.clear()
        super().begin_episode(inputs)

    def choose(self) -> NDArray[np.int64]:
        """Choose by the roulette, and put it into the queue."""
        chosen = self.roulette(self.state, self.settings.base_weight)
        self.queue.grow(self.states.capacity)
        self.queue.push(self.state, chosen)
        return self.problem.space.alternatives_of(chosen)

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Move to the next state; what was chosen is a step further away."""
        super().advance(inputs)
        self.queue.decay(self.settings.discount)

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Share the reward by eligibility, which is zero outside of the queue."""
        queued = np.unique(self.queue.states[: self.queue.filled])
        self.q[queued] += value * self.queue.eligibility[queued]

    def finish_episode(self) -> None:
        """Empty the queue, whose states may be forgotten now."""
        self.queue.clear()
        super().finish_episode()

    def give_up_episode(self) -> None:
        """Become what it was before the episode began, but for the random numbers."""
        self.queue.clear()
        super().give_up_episode()


ENTRY = learner_entry(
    __name__,
    OnlineSettings,
    lambda options, settings, problem, rng: OnlineProfitSharing(
        options, settings.states, problem, rng
    ),
)
