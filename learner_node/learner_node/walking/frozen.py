"""Walks without learning: greedy from a memory, or the static walk uncorrected."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.walking.actions import NO_CORRECTION_M, corrections_m
from learner_node.walking.cost import CostIntegral
from learner_node.walking.inputs import sensory_input
from learner_node.walking.settings import LearnerSettings
from learner_node.xol.agent import XolAgent
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

Decide = Callable[[Observation], NDArray[np.float64]]


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
    settings: LearnerSettings, target_ticks: int, agent: XolAgent
) -> FrozenWalk:
    """Return the frozen greedy walk of what an agent has learned.

    Where the agent knows no state of the present phase, the walk is not corrected.
    """
    alternatives_m = corrections_m(settings.action)

    def decide(observation: Observation) -> NDArray[np.float64]:
        chosen = agent.greedy(sensory_input(observation))
        return NO_CORRECTION_M if chosen is None else alternatives_m[chosen]

    return FrozenWalk(settings, target_ticks, decide)


def static_walk(settings: LearnerSettings, target_ticks: int) -> FrozenWalk:
    """Return the walk without any correction."""
    return FrozenWalk(settings, target_ticks, lambda _: NO_CORRECTION_M)
