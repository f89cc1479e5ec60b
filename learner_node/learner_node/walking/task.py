"""The task of Section 4: learn the waist trajectory of a biped's walk.

    inputs          the eight of Section 4.1, from an observation
    actions         corrections (dx, dy) of the waist (Section 4.2)
    outcome         penalties of Table 1, rewards of Table 2
    schedule, cost  when the walk is over, and what it cost: `schedule.py`, `cost.py`

All that is particular to walking stands here; a learner sees inputs, alternatives and
outcomes only.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import (
    CONTROL_PERIOD_US,
    LEARNING_PERIOD_US,
    TICKS_PER_LEARNING_TICK,
    microseconds,
)
from learner_node.learner import Outcome
from learner_node.problem import ActionSpace, Problem
from learner_node.walking.cost import CostEstimate, CostIntegral
from learner_node.walking.response import zmp_response
from learner_node.walking.schedule import LearningSchedule
from learner_node.walking.settings import InputSettings, LearnerSettings
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

INPUT_NAMES = (
    "right_support",
    "double_support",
    "waist_x",
    "waist_y",
    "zmp_error_x",
    "zmp_error_y",
    "waist_acceleration_x",
    "waist_acceleration_y",
)
N_DISCRETE = 2
COMPONENTS = ("dx", "dy")
NO_CORRECTION_M = np.zeros(len(COMPONENTS))
NO_CORRECTION_M.flags.writeable = False

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
    EndCause.TILT: 0,
}
N_PENALTIES = 3  # Table 1, the additional penalty included

# The paper's values for its two discrete inputs.
_YES, _NO = 10.0, -10.0


def sensory_input(
    observation: Observation, settings: InputSettings
) -> NDArray[np.float64]:
    """Return the (8,) inputs, in the order of INPUT_NAMES; a clock is a ninth.

    Flags are the planned ones, +10 or -10; the rest is in SI units and is scaled by the
    widths of the basis functions.
    """
    phase = observation.phase
    inputs = (
        _YES if phase.planned_right_support else _NO,
        _YES if phase.planned_double_support else _NO,
        *observation.waist_in_support_foot_m,
        *observation.zmp_error_m,
        *observation.waist_acceleration_m_s2,
    )
    if not settings.clock_period_s:
        return np.array(inputs)
    walked_us = observation.control_tick * CONTROL_PERIOD_US
    return np.array((*inputs, walked_us % microseconds(settings.clock_period_s) * 1e-6))


class End(NamedTuple):
    """How a walk ended: for the learner, and for everybody else.

    Where the outcome says that it has not ended, it goes on to the next target.
    """

    outcome: Outcome
    result: EpisodeResult


class WalkTask:
    """One walk after the other, each judged when it ends."""

    def __init__(self, settings: LearnerSettings, walk_ticks: int) -> None:
        """Lay out the schedule.

        Args:
            settings: constants of the task, among those of the learner.
            walk_ticks: control ticks of the whole walk.
        """
        self.settings = settings
        action = settings.action
        self.problem = Problem(
            N_DISCRETE,
            settings.inputs.radii,
            ActionSpace((action.alternatives,) * len(COMPONENTS)),
            (settings.rewards.penalty,) * N_PENALTIES,
        )
        self.schedule = LearningSchedule(settings.schedule, walk_ticks)
        self.estimate = CostEstimate(settings.cost)
        self._cost = CostIntegral(settings.cost)
        self._alternatives_m = np.linspace(
            -action.limit_m, action.limit_m, action.alternatives
        )
        self._hold_control_ticks = action.hold_ticks * TICKS_PER_LEARNING_TICK
        self._unproved = -(
            -microseconds(settings.schedule.proof_s)
            // (action.hold_ticks * LEARNING_PERIOD_US)
        )
        step_m = float(self._alternatives_m[1] - self._alternatives_m[0])
        self._push = step_m * zmp_response(settings.blame, action.hold_ticks)
        self.begin()

    def begin(self) -> None:
        """Begin a walk."""
        self._cost.reset()
        self._earned = 0.0
        self._before = self.progress()

    def give_up(self) -> None:
        """Take back what the walk under way has led to."""
        self.restore(self._before)

    def end(self, observation: Observation) -> End | None:
        """Take an observation into account; return how the walk ended, if it has.

        With `schedule.run_on`, a walk that masters a subtask other than the last has
        an end there, too, whose outcome says that it goes on.
        """
        self._cost.add(observation)
        if observation.end_cause is not None:
            return self._failed(observation, observation.end_cause)
        if observation.control_tick >= self.schedule.target_ticks:
            return self._completed(observation)
        return None

    def inputs(self, observation: Observation) -> NDArray[np.float64]:
        """Return what a learner is given of an observation (`sensory_input`)."""
        return sensory_input(observation, self.settings.inputs)

    def decides(self, observation: Observation) -> bool:
        """Return whether a decision is due; between decisions one is held."""
        return observation.control_tick % self._hold_control_ticks == 0

    def correction_m(self, chosen: NDArray[np.int64]) -> NDArray[np.float64]:
        """Return the (2,) correction [m] that the chosen alternatives stand for."""
        return self._alternatives_m[chosen]

    def _failed(self, observation: Observation, cause: EndCause) -> End:
        return End(
            Outcome(
                penalty=PENALTY_OF.get(cause),
                push=self._push_of(observation, cause),
                ended=True,
            ),
            self._cost.result(
                observation,
                cause,
                self.schedule.target_ticks,
                learning=True,
                reward=self._earned,
                subtask=self.schedule.subtask,
                schedule_complete=self.schedule.complete,
            ),
        )

    def _push_of(
        self, observation: Observation, cause: EndCause
    ) -> NDArray[np.float64] | None:
        """Return what led to a failure (`Learner.penalise`), if that is known [m]."""
        if not self.settings.blame.directed or cause is not EndCause.ZMP_ERROR:
            return None
        error_m = np.array(observation.zmp_error_m)
        size_m = float(np.hypot(*error_m))
        return None if size_m == 0.0 else np.outer(self._push, error_m / size_m)

    def _completed(self, observation: Observation) -> End:
        """Pay the reward of Table 2 and move on in the schedule."""
        terms = self._cost.terms(observation)
        if terms is None:
            raise ValueError("a walk without a control tick cannot succeed")
        schedule, estimate, rewards = (
            self.schedule,
            self.estimate,
            self.settings.rewards,
        )
        subtask, target_ticks = schedule.subtask, schedule.target_ticks
        whole_task, compared_with = schedule.complete, estimate.value
        success = estimate.is_success(terms.total)
        estimate.update(terms.total)
        reward = rewards.success if success else rewards.goal
        finished = success and schedule.count_success()
        if finished and not schedule.complete:
            # T_err grows with t_f: each subtask has its own estimate.
            estimate.value = None
        goes_on = self.settings.schedule.run_on and finished and not schedule.complete
        self._earned += reward
        return End(
            Outcome(
                reward=reward,
                counts=success,
                whole_task=whole_task,
                unproved=self._unproved if goes_on else 0,
                subtask_finished=finished,
                ended=not goes_on,
            ),
            self._cost.result(
                observation,
                EndCause.COMPLETED,
                target_ticks,
                learning=True,
                compared_with=compared_with,
                reward=self._earned,
                subtask=subtask,
                schedule_complete=schedule.complete,
            ),
        )

    # -- checkpoint ----------------------------------------------------------------

    def progress(self) -> dict[str, Any]:
        """Return how far schedule and estimate have come, between two walks."""
        return {
            "subtask": self.schedule.subtask,
            "successes": self.schedule.successes,
            "schedule_complete": self.schedule.complete,
            "t_err_estimate": self.estimate.value,
        }

    def restore(self, progress: dict[str, Any]) -> None:
        """Go on from there.

        Raises:
            KeyError, TypeError, ValueError: the content does not fit these settings.
        """
        schedule, estimate = self.schedule, progress["t_err_estimate"]
        subtask = int(progress["subtask"])
        if not 0 <= subtask < len(schedule.targets):
            raise ValueError(f"subtask {subtask} of {len(schedule.targets)}")
        schedule.subtask = subtask
        schedule.successes = int(progress["successes"])
        schedule.complete = bool(progress["schedule_complete"])
        self.estimate.value = None if estimate is None else float(estimate)
