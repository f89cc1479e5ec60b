"""Uniform choice for ever: the floor, below which nothing has been learned."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_lab.contestant import NoOptions
from biped_lab.learner_contestant import learner_entry
from learner_node.learner import Push
from learner_node.memory import Arrays, check_memory
from learner_node.problem import Problem


class RandomChoice:
    """Answers the calls of `learner_node.learner.Learner`, and learns nothing."""

    def __init__(self, problem: Problem, rng: np.random.Generator) -> None:
        """Look at the actions.

        Args:
            problem: inputs, actions and penalties.
            rng: source of every choice.
        """
        self.problem = problem
        self.rng = rng
        self.episode = 0

    def begin_episode(self, inputs: NDArray[np.float64]) -> None:
        """Count the episode."""
        self.episode += 1

    def choose(self) -> NDArray[np.int64]:
        """Choose any alternative of each component."""
        return self.rng.integers(self.problem.space.alternatives)

    def advance(self, inputs: NDArray[np.float64]) -> None:
        """Look nowhere."""

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Learn nothing."""

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Learn nothing."""
        self.problem.check_penalty(penalty)

    def finish_subtask(self) -> None:
        """Learn nothing."""

    def finish_episode(self) -> None:
        """Keep nothing."""

    def give_up_episode(self) -> None:
        """Do not count the episode."""
        self.episode -= 1

    def greedy(self, inputs: NDArray[np.float64]) -> NDArray[np.int64] | None:
        """Return None: no state is known."""
        return None

    def figures(self) -> dict[str, float]:
        """Return nothing."""
        return {}

    def memory(self) -> Arrays:
        """Return the number of episodes."""
        return {"episode": np.array(self.episode, dtype=np.int64)}

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `memory` returned.

        Raises:
            ValueError: an array is missing or is not what `memory` returns.
        """
        check_memory(memory, self.memory(), count=0)
        self.episode = int(memory["episode"])


ENTRY = learner_entry(
    __name__,
    NoOptions,
    lambda options, settings, problem, rng: RandomChoice(problem, rng),
)
