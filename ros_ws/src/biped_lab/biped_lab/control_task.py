"""A task on which learners are compared, and how long they take to learn it.

What counts is the frozen policy: from time to time it is tried on fresh starts, and the
task is learned when its mean score, usually the return, reaches the goal.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import gymnasium
import numpy as np

from biped_lab.gym_learning import GymTask, Judge, perform, practise
from learner_node.learner import Learner
from learner_node.methods import MakeLearner, MethodSettings, make_learner

Environment = gymnasium.Env[Any, Any]


@dataclass(frozen=True)
class ControlTask:
    """What is to be learned, when it is, and with which constants."""

    make: Callable[[], Environment]
    """Makes the environment, of discrete or discretised actions."""
    radii: tuple[float, ...]
    """Width per continuous input."""
    settings: MethodSettings
    """Of XoL and of Q(lambda), on the same states."""
    goal: float
    """Mean score of the frozen policy, at which the task is learned."""
    best: float
    """A score that no episode can exceed."""
    most_episodes: int
    """Learning episodes, after which nobody waits any longer."""
    check_every: int = 25
    """Learning episodes from one trial of the frozen policy to the next."""
    judge: Judge | None = None
    """What a step means to a learner; see `GymTask`."""
    judge_of_values: Judge | None = None
    """What it means to Q(lambda), if not the same."""
    score: Callable[[Environment], float] | None = None
    """How good the episode was that has just ended; its return, if nothing is said."""
    make_continuous: Callable[[], Environment] | None = None
    """Makes the environment with its own actions, where they are continuous."""

    def asked(self, method: str) -> GymTask:
        """Return the environment, new, in the terms of a learner of this method."""
        of_values = method == "q_lambda" and self.judge_of_values is not None
        judge = self.judge_of_values if of_values else self.judge
        return GymTask(self.make(), judge, self.radii)


class Learned(NamedTuple):
    """How long it took."""

    reached: bool
    """The goal was; otherwise the rest says for how long it was not."""
    episodes: int
    steps: int
    """Of learning; those of the trials are not counted."""


TRIALS = 20
"""Episodes of the frozen policy, of which the mean score is taken."""


def good_enough(task: ControlTask, trial: Callable[[], float]) -> bool:
    """Return whether the mean score of all trials reaches the goal.

    Args:
        task: has the goal.
        trial: performs once from a fresh start and returns the score. No more are made
            once the goal is out of reach.
    """
    total = 0.0
    for done in range(1, TRIALS + 1):
        total += trial()
        if total + (TRIALS - done) * task.best < TRIALS * task.goal:
            return False
    return True


def performed(task: ControlTask, asked: GymTask, learner: Learner) -> float:
    """Perform once, frozen; return the score."""
    done = perform(asked, learner)
    return done.total_reward if task.score is None else task.score(asked.env)


def learn(
    task: ControlTask,
    settings: MethodSettings,
    seed: int,
    make: MakeLearner = make_learner,
) -> Learned:
    """Let a learner practise until its frozen policy is good enough.

    Args:
        task: what is learned.
        settings: which learner, with which constants.
        seed: of the learner, and of the environments that it learns and is tried in.
        make: makes the learner.
    """
    of_learner, of_practice, of_trials = np.random.SeedSequence(seed).spawn(3)
    practice, trials = task.asked(settings.method), task.asked(settings.method)
    # A seed sets the generator of an environment, from which later starts are drawn.
    for asked, sequence in ((practice, of_practice), (trials, of_trials)):
        asked.env.reset(seed=int(sequence.generate_state(1)[0]))
    learner = make(settings, practice.problem, np.random.default_rng(of_learner))
    steps = 0
    for episode in range(1, task.most_episodes + 1):
        steps += practise(practice, learner).steps
        if episode % task.check_every == 0 and good_enough(
            task, lambda: performed(task, trials, learner)
        ):
            return Learned(True, episode, steps)
    return Learned(False, task.most_episodes, steps)


def show(task: ControlTask, seed: int) -> int:
    """Let a task be learned, and print how long it took; exit status 1 if it was not.

    Args:
        task: says by its settings who learns it.
        seed: see `learn`.
    """
    learned = learn(task, task.settings, seed)
    came = "learned" if learned.reached else "not learned"
    print(f"{came} after {learned.episodes} episodes, {learned.steps} steps")
    return 0 if learned.reached else 1
