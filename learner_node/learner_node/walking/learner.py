"""The learner of the walk: answers every observation with a correction or a result."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.memory_hash import Arrays, arrays_sha256
from learner_node.walking.actions import (
    N_COMPONENTS,
    NO_CORRECTION_M,
    corrections_m,
)
from learner_node.walking.cost import CostEstimate, CostIntegral
from learner_node.walking.inputs import sensory_input
from learner_node.walking.schedule import LearningSchedule
from learner_node.walking.settings import (
    N_CONTINUOUS,
    N_DISCRETE,
    LearnerSettings,
)
from learner_node.xol.agent import XolAgent
from learner_node.xol.rules import ActionSpace
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

# Penalty type (0-based) of each failure. Table 1 names the first two; the paper's text
# lists the others as failures too, and they get the highest priority. Ends that are
# not in this table are the simulation's fault, and the learner is not blamed for them.
PENALTY_OF = {
    EndCause.ZMP_ERROR: 0,
    EndCause.JOINT_VELOCITY: 1,
    EndCause.IK_UNREACHABLE: 0,
    EndCause.IK_JOINT_LIMIT: 0,
    EndCause.TORQUE_SATURATION: 0,
    EndCause.FEET_UNLOADED: 0,
}
N_PENALTIES = 3  # Table 1, the additional penalty included


class WalkLearner:
    """XoL on the waist trajectory: the task of Section 4."""

    def __init__(
        self, settings: LearnerSettings, walk_ticks: int, rng: np.random.Generator
    ) -> None:
        """Start knowing nothing.

        Args:
            settings: all constants.
            walk_ticks: control ticks of the whole walk.
            rng: source of every random choice.
        """
        self.settings = settings
        xol = replace(
            settings.xol,
            states=replace(settings.xol.states, radii=settings.inputs.radii),
        )
        self.agent = XolAgent(
            xol,
            ActionSpace(N_COMPONENTS, settings.action.alternatives),
            N_DISCRETE,
            N_CONTINUOUS,
            (settings.rewards.penalty,) * N_PENALTIES,
            rng,
        )
        self.schedule = LearningSchedule(settings.schedule, walk_ticks)
        self.estimate = CostEstimate(settings.cost)
        self._cost = CostIntegral(settings.cost)
        self._alternatives_m = corrections_m(settings.action)
        self._hold_control_ticks = settings.action.hold_ticks * TICKS_PER_LEARNING_TICK
        self._held_m = NO_CORRECTION_M

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Learn from an observation and answer it.

        An observation at control tick 0 begins an episode.

        Returns:
            The (2,) correction [m] for the coming learning tick, or the result where
            the walk has failed or reached its target time.
        """
        begins = observation.control_tick == 0
        if begins:
            self._cost.reset()
        self._cost.add(observation)
        if observation.end_cause is not None:
            return self._fail(observation, observation.end_cause)
        if observation.control_tick >= self.schedule.target_ticks:
            return self._succeed(observation)
        if observation.control_tick % self._hold_control_ticks == 0:
            inputs = sensory_input(observation)
            if begins:
                self.agent.begin_episode(inputs)
            else:
                self.agent.advance(inputs)
            self._held_m = self._alternatives_m[self.agent.choose()]
        return self._held_m

    def _fail(self, observation: Observation, cause: EndCause) -> EpisodeResult:
        if cause in PENALTY_OF:
            self.agent.penalise(PENALTY_OF[cause])
        self.agent.finish_episode()
        return self._cost.result(
            observation,
            cause,
            self.schedule.target_ticks,
            learning=True,
            subtask=self.schedule.subtask,
            schedule_complete=self.schedule.complete,
        )

    def _succeed(self, observation: Observation) -> EpisodeResult:
        """Pay the reward of Table 2 and move on in the schedule."""
        terms = self._cost.terms(observation)
        if terms is None:
            raise ValueError("a walk without a control tick cannot succeed")
        subtask, target_ticks = self.schedule.subtask, self.schedule.target_ticks
        compared_with = self.estimate.value
        success = self.estimate.is_success(terms.total)
        self.estimate.update(terms.total)
        rewards = self.settings.rewards
        reward = rewards.success if success else rewards.goal
        self.agent.reward(reward, success, whole_task=self.schedule.complete)
        if success and self.schedule.count_success():
            self.agent.finish_subtask()
            if not self.schedule.complete:
                # T_err grows with t_f: each subtask has its own estimate.
                self.estimate.value = None
        self.agent.finish_episode()
        return self._cost.result(
            observation,
            EndCause.COMPLETED,
            target_ticks,
            learning=True,
            compared_with=compared_with,
            reward=reward,
            subtask=subtask,
            schedule_complete=self.schedule.complete,
        )

    # -- checkpoint ----------------------------------------------------------------

    def memory_sha256(self) -> str:
        """Return a hash of all that was learned."""
        return arrays_sha256(self.agent.memory())

    def progress(self) -> dict[str, Any]:
        """Return what goes into a checkpoint's header beside the agent's memory."""
        return {
            "subtask": self.schedule.subtask,
            "successes": self.schedule.successes,
            "schedule_complete": self.schedule.complete,
            "t_err_estimate": self.estimate.value,
            "rng": self.agent.rng.bit_generator.state,
        }

    def restore(self, progress: dict[str, Any], memory: Arrays) -> None:
        """Go on between two episodes, as if never interrupted.

        Raises:
            KeyError, TypeError, ValueError: the content does not fit these settings.
        """
        subtask = int(progress["subtask"])
        if not 0 <= subtask < len(self.schedule.targets):
            raise ValueError(f"subtask {subtask} of {len(self.schedule.targets)}")
        estimate = progress["t_err_estimate"]
        self.agent.restore(memory)
        self.agent.rng.bit_generator.state = progress["rng"]
        self.schedule.subtask = subtask
        self.schedule.successes = int(progress["successes"])
        self.schedule.complete = bool(progress["schedule_complete"])
        self.estimate.value = None if estimate is None else float(estimate)
