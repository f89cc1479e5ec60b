"""A learning session: learner, frozen trials, tally and log, walk after walk.

The same object learns in one process, in a ROS node and in tests. It sees nothing but
observations, and what it needs to go on bit for bit is in one checkpoint.

A walk that ends from outside (late, peer silent, reset, disturbed) is given up, and so
is one whose beginning was not seen or that another one cuts off: it leaves nothing
behind but a number in the tally, and the next walk is walked with the very same draws.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from biped_common.seeds import learner_stream
from biped_common.timing import seconds
from learner_node.memory import Arrays, arrays_sha256
from learner_node.methods import MakeLearner, make_learner
from learner_node.walking.cost import CostIntegral
from learner_node.walking.episode_log import EpisodeLog
from learner_node.walking.settings import LearnerSettings
from learner_node.walking.task import WalkTask
from learner_node.walking.walks import FrozenWalk, LearningWalk, greedy_walk
from msgs_json.bounds import Count, Digest
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.observation import Observation

_MEMORY, _LOG = "memory", "log"


@dataclass
class Tally:
    """Counts of a session, beside memory and schedule."""

    simulated_ticks: Count = 0
    """Control ticks of all learning episodes."""
    evaluation_ticks: Count = 0
    """Control ticks of all frozen greedy walks."""
    evaluations: Count = 0
    schedule_episodes: Count | None = None
    """Episodes when the schedule was complete."""
    greedy_episodes: Count | None = None
    """Episodes when a frozen greedy walk first succeeded."""
    trajectories_sha256: Digest = ""
    """Chained over the learning episodes."""
    given_up: dict[EndCause, Count] = field(default_factory=dict)
    """Walks that nothing was made of, by what ended them."""

    def give_up(self, cause: EndCause) -> None:
        """Count a walk of which nothing else is kept."""
        self.given_up[cause] = self.given_up.get(cause, 0) + 1


class _Progress(msgspec.Struct, forbid_unknown_fields=True):
    """How far schedule, estimate and chance have come, as in a checkpoint's header."""

    subtask: Count
    successes: Count
    schedule_complete: bool
    t_err_estimate: float | None
    rng: dict[str, Any]


class _Header(msgspec.Struct):
    """What of a checkpoint's header is the session's."""

    seed: int
    progress: _Progress
    trial_due: bool
    tally: Tally


class LearningSession:
    """Answers observations, learns from them, and tries the walk frozen when due."""

    def __init__(
        self,
        settings: LearnerSettings,
        walk_ticks: int,
        seed: int,
        make: MakeLearner = make_learner,
    ) -> None:
        """Start from nothing.

        Args:
            settings: all constants of the learner.
            walk_ticks: control ticks of the whole walk.
            seed: of every random choice of the learner.
            make: who learns; by default whom the settings name.
        """
        self.settings = settings
        self.seed = seed
        self.walk_ticks = walk_ticks
        self.task = WalkTask(settings, walk_ticks)
        self.learner = make(
            settings, self.task.problem, np.random.default_rng(learner_stream(seed))
        )
        self._learning = LearningWalk(self.task, self.learner)
        self.tally = Tally()
        self.log = EpisodeLog()
        self.frozen = False
        """Set by a user: walks are greedy, and nothing is learned."""
        self._trial_due = False
        self.walking = False
        """Whether a walk is under way; checkpoints are taken between walks."""
        self._walk: LearningWalk | FrozenWalk = self._learning
        self._begun = ("", 0)
        """Simulation and number of the walk that was last begun or given up."""

    @property
    def episodes(self) -> int:
        """Learning episodes so far."""
        return len(self.log)

    @property
    def learned(self) -> bool:
        """Schedule complete, and a frozen greedy walk has succeeded."""
        return self.tally.greedy_episodes is not None

    @property
    def trial_due(self) -> bool:
        """Whether the next walk is a frozen trial.

        Trials follow learning episodes that completed the whole walk, once the schedule
        is complete: a learner that does not complete it with chance on its side will
        not do so without.
        """
        return self._trial_due

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Return the correction [m] for the coming learning tick, or the result.

        A walk whose beginning was not seen is given up.
        """
        walk = (observation.simulation, observation.episode)
        if observation.control_tick == 0 and observation.end_cause is None:
            self.cut_off(EndCause.PEER_SILENT)
            self._walk = (
                self.greedy() if self.frozen or self._trial_due else self._learning
            )
            self._begun = walk
            self.walking = True
        elif not self.walking or walk != self._begun:
            return self._unseen(observation)
        answer = self._walk.respond(observation)
        if isinstance(answer, EpisodeResult):
            self.walking = False
            if not answer.learning:
                schedule = self.task.schedule
                answer = msgspec.structs.replace(
                    answer,
                    subtask=schedule.subtask,
                    schedule_complete=schedule.complete,
                )
            self._count(answer)
        return answer

    def over(self, observation: Observation) -> bool:
        """Return whether the result of this walk has been told already.

        In real time the robot walks on until it hears it.
        """
        walk = (observation.simulation, observation.episode)
        begins = observation.control_tick == 0 and observation.end_cause is None
        return walk == self._begun and not self.walking and not begins

    def _unseen(self, observation: Observation) -> EpisodeResult:
        """Return the result of a walk that was joined in its middle, if at all."""
        self.cut_off(EndCause.PEER_SILENT)
        walk = (observation.simulation, observation.episode)
        if walk != self._begun:  # more of it may come before the robot hears of this
            self._begun = walk
            cause = observation.end_cause
            if cause is None or not cause.from_outside:
                cause = EndCause.PEER_SILENT
            self.tally.give_up(cause)
        schedule, cost = self.task.schedule, CostIntegral(self.settings.cost)
        cost.add(observation)
        result = cost.result(
            observation,
            observation.end_cause or EndCause.PEER_SILENT,
            schedule.target_ticks,
            subtask=schedule.subtask,
            schedule_complete=schedule.complete,
        )
        return msgspec.structs.replace(result, cost=None)

    def cut_off(self, cause: EndCause) -> None:
        """Give up the walk under way, if there is one: its end is not heard."""
        if self.walking:
            self.walking = False
            self._learning.give_up()
            self.tally.give_up(cause)

    def greedy(self) -> FrozenWalk:
        """Return a frozen greedy walk of the present memory."""
        return greedy_walk(self.settings, self.walk_ticks, self.learner, self.task)

    def memory_sha256(self) -> str:
        """Return a hash of all that was learned."""
        return arrays_sha256(self.learner.memory())

    def status(self, instance: str) -> LearnerStatus:
        """Return how far the session has come, under the learner's name."""
        schedule = self.task.schedule
        return LearnerStatus(
            instance=instance,
            seed=self.seed,
            target_time_s=seconds(schedule.target_ticks),
            subtask=schedule.subtask,
            subtasks=len(schedule.targets),
            successes=schedule.successes,
            episodes=self.episodes,
            survival=self.log.survival(),
            figures=self.learner.figures(),
            t_err_estimate=self.task.estimate.value,
            schedule_complete=schedule.complete,
            learned=self.learned,
            frozen=self.frozen,
            given_up=dict(self.tally.given_up),
            simulated_s=seconds(self.tally.simulated_ticks),
            memory_sha256=self.memory_sha256(),
            trajectory_sha256=self.tally.trajectories_sha256,
        )

    def header(self) -> dict[str, Any]:
        """Return what goes into a checkpoint's header."""
        return {
            "seed": self.seed,
            "progress": {
                **self.task.progress(),
                "rng": self.learner.rng.bit_generator.state,
            },
            "trial_due": self._trial_due,
            "tally": asdict(self.tally),
        }

    def arrays(self) -> Arrays:
        """Return what goes into a checkpoint as arrays."""
        groups = {_MEMORY: self.learner.memory(), _LOG: self.log.arrays()}
        return {
            f"{group}/{name}": array
            for group, arrays in groups.items()
            for name, array in arrays.items()
        }

    def restore(self, header: Mapping[str, Any], arrays: Arrays) -> None:
        """Go on between two walks, as if never interrupted.

        Raises:
            ArithmeticError, LookupError, TypeError, ValueError,
            msgspec.ValidationError: the content does not fit these settings.
        """
        found = msgspec.convert(dict(header), _Header)
        # Older checkpoints do not know of walks that were given up.
        counts = {*header["tally"], "given_up"}
        if counts != asdict(found.tally).keys():
            raise ValueError(f"tally: counts {sorted(counts)}")
        groups: dict[str, Arrays] = {_MEMORY: {}, _LOG: {}}
        for name, array in arrays.items():
            group, _, key = name.partition("/")
            groups[group][key] = array
        log = EpisodeLog(groups[_LOG])
        self.learner.restore(groups[_MEMORY])
        self.learner.rng.bit_generator.state = found.progress.rng
        self.task.restore(header["progress"])
        self.seed = found.seed
        self._trial_due = found.trial_due
        self.tally, self.log = found.tally, log

    def _count(self, result: EpisodeResult) -> None:
        tally = self.tally
        if result.end_cause.from_outside:
            tally.give_up(result.end_cause)
            return
        if not result.learning:
            tally.evaluations += 1
            tally.evaluation_ticks += result.control_ticks
            if self._trial_due and result.completed:
                tally.greedy_episodes = self.episodes
            self._trial_due = False
            return
        tally.simulated_ticks += result.control_ticks
        tally.trajectories_sha256 = hashlib.sha256(
            (tally.trajectories_sha256 + result.trajectory_sha256).encode()
        ).hexdigest()
        self.log.append(result)
        if result.schedule_complete and tally.schedule_episodes is None:
            tally.schedule_episodes = self.episodes
        self._trial_due = (
            result.schedule_complete and result.completed and not self.learned
        )
