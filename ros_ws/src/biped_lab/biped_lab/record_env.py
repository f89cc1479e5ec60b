"""Progress within an episode as successes: each new record, by so much, is one.

A task whose goal chance never reaches is broken down into shorter ones by it, as a
learning schedule does (Section 3.3), only that the episode goes on.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium

from learner_node.learner import Outcome

Environment = gymnasium.Env[Any, Any]


class RecordEnv(gymnasium.Wrapper[Any, Any, Any, Any]):
    """Says in `info["outcome"]` what a step means; see `gym_learning.told_by_info`."""

    def __init__(
        self,
        env: Environment,
        measure: Callable[[Environment], float],
        first: float,
        rise: float,
        fails: bool,
    ) -> None:
        """Measure an environment.

        Args:
            env: the environment.
            measure: how far the episode has come, in any unit.
            first: the first record, reached when the measure is at least that.
            rise: from one record to the next, in the same unit.
            fails: a terminated episode has failed, with penalty 0; otherwise it has
                reached the goal, which is a success.
        """
        super().__init__(env)
        self._measure, self._first, self._rise = measure, first, rise
        self._fails = fails
        self._next = first

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode without records."""
        self._next = self._first
        return self.env.reset(seed=seed, options=options)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Step, and judge the step."""
        seen, reward, terminated, truncated, info = self.env.step(action)
        reached = self._measure(self.env)
        success = reached >= self._next or (terminated and not self._fails)
        while reached >= self._next:
            self._next += self._rise
        outcome = Outcome(
            reward=1.0 if success else None,
            counts=success,
            penalty=0 if terminated and self._fails else None,
            ended=terminated or truncated,
        )
        info = info | {"outcome": outcome}
        return seen, float(reward), terminated, truncated, info
