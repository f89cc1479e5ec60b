"""A learner on any Gymnasium environment of Box or Discrete observations.

Actions are Discrete or MultiDiscrete: one component each. Continuous observations need
a width per input, the distance at which two of them call for different decisions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Discrete, MultiDiscrete
from numpy.typing import NDArray

from biped_common.errors import BipedError
from learner_node.learner import GOING_ON, Learner, Outcome, tell
from learner_node.problem import ActionSpace, Problem


class UnfitEnvironmentError(BipedError, ValueError):
    """The environment's spaces are not of a kind that can be learned."""


class Step(NamedTuple):
    """What an environment answered, besides the observation."""

    number: int
    """Steps taken in this episode."""
    reward: float
    terminated: bool
    truncated: bool
    info: dict[str, Any]

    @property
    def ended(self) -> bool:
        """The episode is over."""
        return self.terminated or self.truncated


Judge = Callable[[Step], Outcome]


class GymTask:
    """What an environment asks, in a learner's terms."""

    def __init__(
        self,
        env: gymnasium.Env[Any, Any],
        judge: Judge | None = None,
        radii: Sequence[float] = (),
        penalty_values: Sequence[float] = (10.0, 10.0),
    ) -> None:
        """Look at the environment's spaces.

        Args:
            env: the environment.
            judge: what a step means. Without it, `info["outcome"]` says it, or
                `info["penalty"]` that the episode failed.
            radii: width per continuous input.
            penalty_values: per type, highest priority first; the last one is paid by
                the learner itself, for moving to a penalty state.

        Raises:
            UnfitEnvironmentError: its spaces cannot be learned, or the widths do not
                fit them.
        """
        self.env = env
        self._judge = judge or told_by_info
        observations = env.observation_space
        if isinstance(observations, Discrete):
            n_discrete, n_continuous = 1, 0
        elif isinstance(observations, Box) and len(observations.shape) == 1:
            n_discrete = observations.shape[0] - len(radii)
            n_continuous = len(radii)
        else:
            raise UnfitEnvironmentError(
                f"observation space {observations}: must be a Discrete or a Box of one "
                "dimension; see gymnasium.wrappers.FlattenObservation"
            )
        if len(radii) != n_continuous or n_discrete < 0:
            raise UnfitEnvironmentError(
                f"radii: {len(radii)} given for the observation space {observations}"
            )
        self.problem = Problem(
            n_discrete,
            tuple(radii),
            ActionSpace(_alternatives(env.action_space)),
            tuple(penalty_values),
        )
        self._single = isinstance(env.action_space, Discrete)
        self._start = np.array(getattr(env.action_space, "start", 0))

    def inputs(self, observation: Any) -> NDArray[np.float64]:
        """Return the (Ns,) inputs of an observation; the discrete ones come first."""
        return np.atleast_1d(np.asarray(observation, dtype=np.float64))

    def action(self, chosen: NDArray[np.int64]) -> Any:
        """Return the action that the chosen alternatives stand for."""
        action = chosen + self._start
        return int(action[0]) if self._single else action

    def outcome(self, step: Step) -> Outcome:
        """Return what a step means."""
        return self._judge(step)


class Practice(NamedTuple):
    """An episode that was learned from."""

    steps: int
    total_reward: float
    """The environment's own."""


def practise(task: GymTask, learner: Learner, seed: int | None = None) -> Practice:
    """Learn from one episode.

    Args:
        task: the environment.
        learner: made for `task.problem`.
        seed: of the environment's randomness from here on.
    """
    observation, _ = task.env.reset(seed=seed)
    learner.begin_episode(task.inputs(observation))
    steps, total = 0, 0.0
    while True:
        action = task.action(learner.choose())
        observation, reward, terminated, truncated, info = task.env.step(action)
        steps, total = steps + 1, total + float(reward)
        step = Step(steps, float(reward), terminated, truncated, info)
        outcome = task.outcome(step)
        tell(learner, outcome)
        if outcome.ended:
            return Practice(steps, total)
        learner.advance(task.inputs(observation))


def perform(task: GymTask, learner: Learner, seed: int | None = None) -> Practice:
    """Let a learner do its best for one episode; it learns nothing.

    Where it knows no state, it takes the middle of all alternatives.
    """
    observation, _ = task.env.reset(seed=seed)
    middle = np.array(task.problem.space.alternatives) // 2
    steps, total, over = 0, 0.0, False
    while not over:
        chosen = learner.greedy(task.inputs(observation))
        action = task.action(middle if chosen is None else chosen)
        observation, reward, terminated, truncated, _ = task.env.step(action)
        steps, total, over = steps + 1, total + float(reward), terminated or truncated
    return Practice(steps, total)


# -- judges ---------------------------------------------------------------------------


def told_by_info(step: Step) -> Outcome:
    """Believe the environment: `info["outcome"]`, or else `info["penalty"]`."""
    if "outcome" in step.info:
        outcome: Outcome = step.info["outcome"]
        return outcome
    if "penalty" in step.info:
        return Outcome(penalty=int(step.info["penalty"]), ended=step.ended)
    return Outcome(ended=True) if step.ended else GOING_ON


def failing(step: Step) -> Outcome:
    """Judge only that a terminated episode has failed, with penalty 0."""
    return Outcome(penalty=0 if step.terminated else None, ended=step.ended)


def rewarded(step: Step) -> Outcome:
    """Take the environment's own reward, for learners of values; nothing counts."""
    return Outcome(reward=step.reward, ended=step.ended)


def survival(every: int, first: int = 1) -> Judge:
    """Return a judge for tasks of lasting: each so many steps are a success.

    A terminated episode has failed, with penalty 0.

    Args:
        every: steps from one success to the next.
        first: the step before which there is none, since anything lasts so long.
    """

    def judge(step: Step) -> Outcome:
        if step.terminated:
            return Outcome(penalty=0, ended=True)
        lasted = step.number >= first and (step.number % every == 0 or step.truncated)
        return Outcome(reward=1.0 if lasted else None, counts=lasted, ended=step.ended)

    return judge


def arrival(step: Step) -> Outcome:
    """Judge tasks of arriving: terminated is there, truncated is too late."""
    if step.terminated:
        return Outcome(reward=1.0, counts=True, ended=True)
    return Outcome(ended=True) if step.truncated else GOING_ON


def _alternatives(space: gymnasium.Space[Any]) -> tuple[int, ...]:
    if isinstance(space, Discrete):
        return (int(space.n),)
    if isinstance(space, MultiDiscrete) and space.nvec.ndim == 1:
        return tuple(int(n) for n in space.nvec)
    raise UnfitEnvironmentError(
        f"action space {space}: must be Discrete, or MultiDiscrete of one dimension"
    )
