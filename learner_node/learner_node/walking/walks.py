"""Who answers a robot's observations: a learner, its frozen memory, or nobody.

All answer with the correction for the coming learning tick, or with the result where
the walk has failed or reached its target time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.learner import Learner, tell
from learner_node.walking.cost import CostIntegral
from learner_node.walking.settings import LearnerSettings
from learner_node.walking.task import NO_CORRECTION_M, WalkTask
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

Decide = Callable[[Observation], NDArray[np.float64]]


class LearningWalk:
    """Leads a learner through the task."""

    def __init__(self, task: WalkTask, learner: Learner) -> None:
        """Prepare for walk after walk."""
        self._task = task
        self._learner = learner
        self._held_m = NO_CORRECTION_M
        self._chance: Any = None
        """State of the learner's generator when the walk began; None between walks."""

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Learn from an observation; return the (2,) correction [m] or the result.

        An observation at control tick 0 begins an episode. A walk that ends from
        outside is given up.
        """
        task, learner = self._task, self._learner
        begins = observation.control_tick == 0
        if begins:
            task.begin()
        end = task.end(observation)
        if end is not None:
            if end.result.end_cause.from_outside:
                self.give_up()
                return end.result
            tell(learner, end.outcome)
            if end.outcome.ended:
                self._chance = None
                return end.result
        if task.decides(observation):
            inputs = task.inputs(observation)
            if begins:
                self._chance = learner.rng.bit_generator.state
                learner.begin_episode(inputs)
            else:
                learner.advance(inputs)
            self._held_m = task.correction_m(learner.choose())
        return self._held_m

    def give_up(self) -> None:
        """Take back the walk under way, if any: the next one is walked as it was."""
        if self._chance is not None:
            self._learner.give_up_episode()
            self._learner.rng.bit_generator.state = self._chance
            self._task.give_up()
            self._chance = None


class FrozenWalk:
    """Answers observations like a learner, but nothing changes by it."""

    def __init__(
        self, settings: LearnerSettings, target_ticks: int, decide: Decide
    ) -> None:
        """Prepare a walk.

        Args:
            settings: cost and holding time.
            target_ticks: control ticks to walk.
            decide: gives the (2,) correction [m] for an observation.
        """
        self._decide = decide
        self._target_ticks = target_ticks
        self._cost = CostIntegral(settings.cost)
        self._hold_control_ticks = settings.action.hold_ticks * TICKS_PER_LEARNING_TICK
        self._held_m = NO_CORRECTION_M

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Return the correction [m] for the coming learning tick, or the result."""
        if observation.control_tick == 0:
            self._cost.reset()
        self._cost.add(observation)
        cause = observation.end_cause
        if cause is None and observation.control_tick >= self._target_ticks:
            cause = EndCause.COMPLETED
        if cause is not None:
            return self._cost.result(observation, cause, self._target_ticks)
        if observation.control_tick % self._hold_control_ticks == 0:
            self._held_m = self._decide(observation)
        return self._held_m


def greedy_walk(
    settings: LearnerSettings, target_ticks: int, learner: Learner, task: WalkTask
) -> FrozenWalk:
    """Return the frozen greedy walk of what a learner has learned.

    Where it knows no state of the present phase, the walk is not corrected.
    """

    def decide(observation: Observation) -> NDArray[np.float64]:
        chosen = learner.greedy(task.inputs(observation))
        return NO_CORRECTION_M if chosen is None else task.correction_m(chosen)

    return FrozenWalk(settings, target_ticks, decide)


def static_walk(settings: LearnerSettings, target_ticks: int) -> FrozenWalk:
    """Return the walk without any correction."""
    return FrozenWalk(settings, target_ticks, lambda _: NO_CORRECTION_M)
