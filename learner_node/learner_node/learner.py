"""The seam between a task and who learns it.

A task says what an observation means (`Outcome`); a learner chooses, and is told. Per
decision a learner is called in this order:

    begin_episode(inputs)            at the first decision, or
    advance(inputs)                  at every later one
    choose()                         -> alternatives, which the task carries out
    reward(...), penalise(...)       where the outcome says so
    finish_subtask()                 when a part of the task is mastered
    finish_episode()                 at the end; then begin_episode again

Where something from outside ends an episode, `give_up_episode()` takes back all that it
has led to.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from learner_node.memory import Arrays

Inputs = NDArray[np.float64]
Push = NDArray[np.float64]


class Learner(Protocol):
    """Learns a `Problem` from what it is told; knows no task."""

    rng: np.random.Generator
    """Source of every random choice; saved and set back by who owns the learner."""

    def begin_episode(self, inputs: Inputs) -> None:
        """Take the (Ns,) inputs of an episode's first decision."""

    def choose(self) -> NDArray[np.int64]:
        """Return the (Nm,) index of the chosen alternative per component."""

    def advance(self, inputs: Inputs) -> None:
        """Take the (Ns,) inputs of the next decision."""

    def reward(
        self, value: float, counts: bool, whole_task: bool = True, unproved: int = 0
    ) -> None:
        """Take a reward for what was chosen.

        Args:
            value: rwd.
            counts: it is a success, by which states come nearer to being fixed.
            whole_task: it was earned on the whole task, not on a part of it.
            unproved: that many of the last decisions have yet to show what they lead
                to; the reward is not for them.
        """

    def penalise(self, penalty: int, push: Push | None = None) -> None:
        """Take penalty p_l, 0-based, for what was chosen.

        Args:
            penalty: its type.
            push: (ages, Nm) how far the next higher alternative of a component, instead
                of the one chosen so many decisions ago, would have moved the task
                towards this failure, in any unit; None where that is not known. The
                last decision has age 0.
        """

    def finish_subtask(self) -> None:
        """Take note that a part of the task is mastered."""

    def finish_episode(self) -> None:
        """End the episode."""

    def give_up_episode(self) -> None:
        """Become what it was before `begin_episode`, but for its `rng`."""

    def greedy(self, inputs: Inputs) -> NDArray[np.int64] | None:
        """Return the best known action, None where nothing is known; learn nothing.

        Nothing of the learner changes: no state, count or random number.
        """

    def figures(self) -> dict[str, float]:
        """Return what there is to know about the memory, under names of its own."""

    def memory(self) -> Arrays:
        """Return a copy of all that was learned, as arrays; between episodes."""

    def restore(self, memory: Mapping[str, NDArray[Any]]) -> None:
        """Take over what `memory` returned.

        Raises:
            ValueError: an array is missing or belongs to another problem.
        """


@dataclass(frozen=True)
class Outcome:
    """What the last action led to, in a learner's terms."""

    reward: float | None = None
    counts: bool = False
    """The reward is a success; see `Learner.reward`."""
    whole_task: bool = True
    unproved: int = 0
    """Decisions that the reward is not for; see `Learner.reward`."""
    penalty: int | None = None
    """0-based type; comes before a reward, if there are both."""
    push: Push | None = None
    """What led to the penalty; see `Learner.penalise`."""
    subtask_finished: bool = False
    ended: bool = False
    """The episode is over."""


GOING_ON = Outcome()
"""Nothing to be told."""


def tell(learner: Learner, outcome: Outcome) -> None:
    """Tell a learner what its last action led to."""
    if outcome.penalty is not None:
        learner.penalise(outcome.penalty, outcome.push)
    if outcome.reward is not None:
        learner.reward(
            outcome.reward, outcome.counts, outcome.whole_task, outcome.unproved
        )
    if outcome.subtask_finished:
        learner.finish_subtask()
    if outcome.ended:
        learner.finish_episode()
