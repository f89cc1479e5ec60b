"""Contestants that search: they walk plans open loop, with exact replay.

A walk that reaches its target is a success, whatever it cost: nothing is learned by
walking the same plan again. A plan is its own frozen walk, so that both milestones are
the first walk of the whole walk.

What failures do: a checkpoint that cannot be read, or whose history another searcher,
seed or version would not have come to, is a CheckpointError; nothing is walked.
"""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from biped_bringup.replay import ReplayingWalker
from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import WalkedTicks
from biped_common.seeds import learner_stream, robot_stream
from biped_common.settings import SettingsError, to_mapping
from biped_lab.contestant import AnyOptions, Contestant, Entry, log_table
from biped_lab.searches.plan import COMPONENTS, PlanSpace
from biped_lab.searches.searcher import Searcher, Walked
from learner_node.checkpoint import (
    CheckpointError,
    read_checkpoint,
    taking_over,
    write_checkpoint,
)
from learner_node.memory import arrays_sha256
from learner_node.walking.episode_log import EpisodeLog
from learner_node.walking.task import NO_CORRECTION_M, WalkTask
from msgs_json.bounds import Count, Digest
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

Make = Callable[[RunSettings, PlanSpace, np.random.Generator], Searcher]

_COMPLETED = list(EndCause).index(EndCause.COMPLETED)
_PLANS, _LOG = "plans", "log/"


class Kind(NamedTuple):
    """What tells searching contestants apart."""

    make: Make
    """Returns a searcher that was told nothing yet."""
    space: Callable[[RunSettings], PlanSpace] = PlanSpace.of_knots
    incremental: bool = False
    """The target time grows by the learning schedule, a success per subtask."""


class PlannedWalk:
    """Answers observations by a plan."""

    def __init__(
        self, task: WalkTask, space: PlanSpace, chosen: NDArray[np.int64]
    ) -> None:
        """Prepare a walk of (points, 2) alternatives."""
        self._task = task
        self._space = space
        self._chosen = chosen
        self._held_m = NO_CORRECTION_M

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Return the (2,) correction [m] until the next observation, or the result."""
        task, tick = self._task, observation.control_tick
        if tick == 0:
            task.begin()
        end = task.end(observation)
        if end is not None:
            return end.result
        if task.decides(observation):
            self._held_m = task.correction_m(self._chosen[self._space.point_at(tick)])
        return self._held_m


class _Header(msgspec.Struct):
    """What a checkpoint's header tells."""

    settings: dict[str, Any]
    progress: dict[str, Any]
    trajectories_sha256: Digest
    walked_ticks: WalkedTicks
    cpu_s: float
    whole_walk_episodes: Count | None


class SearchContestant:
    """Asks a searcher for plans, walks them, and tells it how far."""

    def __init__(self, settings: RunSettings, seed: int, kind: Kind) -> None:
        """Start from nothing.

        Raises:
            SettingsError: chance has a part in the walks, so that a plan does not say
                how far it walks.
        """
        if settings.sim.random:
            raise SettingsError(
                "sim.disturbances",
                to_mapping(settings.sim.disturbances),
                "must not be random, nor sensors noisy, where plans are searched",
            )
        self.settings = settings
        self._space = kind.space(settings)
        searching, unused = (
            np.random.default_rng(stream(seed))
            for stream in (learner_stream, robot_stream)
        )
        self._searcher = kind.make(settings, self._space, searching)
        self._walker = ReplayingWalker(settings, unused)
        self._task = planned_task(settings, kind.incremental)
        self._log = EpisodeLog()
        self._plans: list[NDArray[np.int64]] = []
        self._trajectories_sha256 = ""
        self._whole_walk_episodes: int | None = None
        self._cpu_s = 0.0

    @property
    def ticks(self) -> WalkedTicks:
        """Where the control ticks of all walks came from."""
        return self._walker.ticks

    @property
    def cpu_s(self) -> float:
        """Processor time of all episodes."""
        return self._cpu_s

    @property
    def episodes(self) -> int:
        """Plans walked so far."""
        return len(self._log)

    def episode(self) -> None:
        """Walk one more plan."""
        started = time.process_time()
        chosen = self._ask(self._task.schedule.target_ticks)
        result = self._walker.walk(PlannedWalk(self._task, self._space, chosen))
        self._plans.append(chosen)
        self._log.append(result)
        cost = math.inf if result.cost is None else result.cost.total
        self._searcher.tell(Walked(result.control_ticks, result.completed, cost))
        self._trajectories_sha256 = hashlib.sha256(
            (self._trajectories_sha256 + result.trajectory_sha256).encode()
        ).hexdigest()
        if result.schedule_complete and self._whole_walk_episodes is None:
            self._whole_walk_episodes = self.episodes
        self._cpu_s += time.process_time() - started

    def milestone(self, name: str) -> int | None:
        """Return the number of episodes when a plan first walked the whole walk."""
        return self._whole_walk_episodes

    def table(self) -> dict[str, NDArray[Any]]:
        """Return one row per episode, by column."""
        return log_table(self._log)

    def figures(self) -> dict[str, Any]:
        """Return hashes and times, the same in every run."""
        return {
            "simulated_ticks": int(self._log.arrays()["control_ticks"].sum()),
            "evaluation_ticks": 0,
            "memory_sha256": arrays_sha256(self._arrays()),
            "trajectory_sha256": self._trajectories_sha256,
        }

    def close(self) -> None:
        """End the world."""
        self._walker.close()

    def _ask(self, target_ticks: int) -> NDArray[np.int64]:
        points = self._space.points_until(target_ticks)
        return self._space.nearest(self._searcher.ask(points))

    # -- checkpoints ---------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write atomically all that is needed to go on bit for bit."""
        header = _Header(
            settings=to_mapping(self.settings),
            progress=self._task.progress(),
            trajectories_sha256=self._trajectories_sha256,
            walked_ticks=self.ticks,
            cpu_s=self.cpu_s,
            whole_walk_episodes=self._whole_walk_episodes,
        )
        write_checkpoint(path, msgspec.to_builtins(header), self._arrays())

    @classmethod
    def resume(
        cls, path: Path, settings: RunSettings, seed: int, kind: Kind
    ) -> SearchContestant:
        """Return the contestant that `save` wrote, ready for its next episode.

        Raises:
            CheckpointError: the file is no usable checkpoint, or of another search.
        """
        content, arrays = read_checkpoint(path)
        contestant = cls(settings, seed, kind)
        try:
            with taking_over(path):
                header = msgspec.convert(content, _Header)
                if header.settings != to_mapping(settings):
                    raise ValueError("it has other settings")
                plans = arrays.pop(_PLANS)
                log = EpisodeLog(
                    {name.removeprefix(_LOG): array for name, array in arrays.items()}
                )
                contestant._tell_again(plans, log)
                contestant._task.restore(header.progress)
                contestant._trajectories_sha256 = header.trajectories_sha256
                contestant._walker.ticks = header.walked_ticks
                contestant._cpu_s = header.cpu_s
                contestant._whole_walk_episodes = header.whole_walk_episodes
        except CheckpointError:
            contestant.close()
            raise
        return contestant

    def _arrays(self) -> dict[str, NDArray[Any]]:
        shape = (len(self._plans), self._space.points, COMPONENTS)
        return {
            _PLANS: np.array(self._plans, dtype=np.int64).reshape(shape),
            **{f"{_LOG}{name}": array for name, array in self._log.arrays().items()},
        }

    def _tell_again(self, plans: NDArray[np.int64], log: EpisodeLog) -> None:
        """Ask and tell the searcher what it was asked and told before.

        Raises:
            ValueError: it does not propose the same plans.
        """
        columns = log.arrays()
        if plans.shape != (len(log), self._space.points, COMPONENTS):
            raise ValueError(f"plans of shape {plans.shape}, {len(log)} episodes")
        for episode, plan in enumerate(plans):
            chosen = self._ask(int(columns["target_ticks"][episode]))
            if not np.array_equal(chosen, plan):
                raise ValueError(f"episode {episode + 1} has another plan")
            t_err = float(columns["t_err"][episode])
            walked = Walked(
                int(columns["control_ticks"][episode]),
                bool(columns["end_cause"][episode] == _COMPLETED),
                math.inf if math.isnan(t_err) else t_err,
            )
            self._searcher.tell(walked)
        self._plans, self._log = list(plans), log


def search_entry(
    module: str,
    options: type[AnyOptions],
    make: Callable[[AnyOptions, RunSettings, PlanSpace, np.random.Generator], Searcher],
    space: Callable[[RunSettings], PlanSpace] = PlanSpace.of_knots,
    incremental: bool = False,
) -> Entry[AnyOptions]:
    """Return the entry of a searcher.

    Args:
        module: `__name__` of where it is.
        options: its constants.
        make: returns a searcher that was told nothing yet.
        space: the plans that it searches.
        incremental: the target time grows by the learning schedule.
    """

    def kind(own: AnyOptions) -> Kind:
        return Kind(
            lambda settings, space, rng: make(own, settings, space, rng),
            space,
            incremental,
        )

    def begin(settings: RunSettings, own: AnyOptions, seed: int) -> Contestant:
        return SearchContestant(settings, seed, kind(own))

    def resume(
        path: Path, settings: RunSettings, own: AnyOptions, seed: int
    ) -> Contestant:
        return SearchContestant.resume(path, settings, seed, kind(own))

    return Entry(options, begin, resume, module)


def planned_task(settings: RunSettings, incremental: bool = False) -> WalkTask:
    """Return the task of a plan: the whole walk, or a target time that grows."""
    schedule = replace(settings.learner.schedule, successes_per_subtask=1)
    if not incremental:
        schedule = replace(schedule, first_target_s=settings.gait.duration_s)
    learner = replace(settings.learner, schedule=schedule)
    return WalkTask(learner, settings.gait.walk_ticks)
