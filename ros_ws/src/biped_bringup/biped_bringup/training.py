"""A training run: episodes until the walk is learned, with checkpoints in between."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np

from biped_bringup.replay import DEFAULT_MEMORY_BYTES, ReplayingWalker
from biped_bringup.run_settings import RunSettings, changes_in_words
from biped_bringup.walker import WalkedTicks, Walker
from biped_common.seeds import robot_stream
from biped_common.settings import from_mapping, to_mapping
from biped_common.timing import seconds
from learner_node.checkpoint import (
    CheckpointError,
    read_checkpoint,
    taking_over,
    write_checkpoint,
)
from learner_node.methods import MakeLearner, make_learner
from learner_node.walking.episode_log import EpisodeLog
from learner_node.walking.session import LearningSession, Tally
from msgs_json.episode_result import EpisodeResult

# Packages whose version can change a walk's last bit.
_PACKAGES = ("biped", "numpy", "numba", "pybullet", "mujoco-core")


class _Spent(msgspec.Struct):
    """What a checkpoint's header tells of how it was made."""

    walked_ticks: WalkedTicks = msgspec.field(default_factory=WalkedTicks)
    cpu_s: float = 0.0
    versions: dict[str, Annotated[str, msgspec.Meta(pattern=r"^[\w.+!-]{0,50}\Z")]] = {}
    notes: dict[str, Any] = {}


class TrainingRun:
    """Session and robot of one run with one seed, in this process."""

    def __init__(
        self,
        settings: RunSettings,
        seed: int,
        replay_bytes: int = DEFAULT_MEMORY_BYTES,
        make: MakeLearner = make_learner,
    ) -> None:
        """Start from nothing.

        Args:
            settings: of the whole run.
            seed: of every random draw; learner and disturbances have streams of their
                own.
            replay_bytes: memory for the replay of walks, 0 to compute them all. Walks
                with random disturbances are never replayed.
            make: who learns; by default whom the settings name.
        """
        self.settings = settings
        self.seed = seed
        self._robot_rng = np.random.default_rng(robot_stream(seed))
        self.replay_off: str | None = None
        """Why walks are not replayed, in words; None where they are."""
        if settings.sim.random:
            self.replay_off = (
                "random disturbances or noisy sensors make every walk different"
            )
        elif replay_bytes == 0:
            self.replay_off = "as asked"
        self.walker = (
            ReplayingWalker(settings, self._robot_rng, replay_bytes)
            if self.replay_off is None
            else Walker(settings, self._robot_rng)
        )
        self.session = LearningSession(
            settings.learner, self.walker.walk_ticks, seed, make
        )
        self.notes: dict[str, Any] = {}
        """What the run's owner keeps with it, through checkpoints; anything of JSON."""
        self.cpu_s = 0.0
        self.written_by = versions()
        """Package versions that wrote the checkpoint gone on from."""
        self.setting_changes = ""
        """Settings that differ from those of the checkpoint, in words."""

    @property
    def version_changes(self) -> list[str]:
        """Packages that differ from those of the checkpoint, in words."""
        return [
            f"{name} {self.written_by.get(name, 'unknown')} -> {now}"
            for name, now in versions().items()
            if self.written_by.get(name) != now
        ]

    # -- learning ------------------------------------------------------------------

    @property
    def tally(self) -> Tally:
        """The session's counts."""
        return self.session.tally

    @property
    def log(self) -> EpisodeLog:
        """The session's episodes."""
        return self.session.log

    @property
    def episodes(self) -> int:
        """Learning episodes so far."""
        return self.session.episodes

    @property
    def learned(self) -> bool:
        """Schedule complete, and a frozen greedy walk has succeeded."""
        return self.session.learned

    def episode(self) -> EpisodeResult:
        """Walk one learning episode and, where one is due, the trial after it."""
        started = time.process_time()
        result = self.walker.walk(self.session)
        if self.session.trial_due:
            self.walker.walk(self.session)
        self.cpu_s += time.process_time() - started
        return result

    def greedy_walk(self) -> EpisodeResult:
        """Walk the whole walk greedily, without learning."""
        return self.walker.walk(self.session.greedy())

    def nothing_to_do(
        self, max_episodes: int | None, stop_at_schedule: bool
    ) -> str | None:
        """Return why the run has come to its end, in words; None if it has not.

        Args:
            max_episodes: give up then; None for no limit.
            stop_at_schedule: end with the schedule, as the paper does, whether or not
                the frozen greedy walk succeeds.
        """
        if self.learned:
            return "the walk is learned"
        if stop_at_schedule and self.tally.schedule_episodes is not None:
            return "the schedule is complete"
        if max_episodes is not None and self.episodes >= max_episodes:
            return f"{self.episodes} of at most {max_episodes} episodes are walked"
        return None

    def run(
        self,
        max_episodes: int | None,
        stop_at_schedule: bool,
        after_episode: Callable[[EpisodeResult], bool],
    ) -> None:
        """Learn until there is nothing to do.

        Args:
            max_episodes: see `nothing_to_do`.
            stop_at_schedule: see `nothing_to_do`.
            after_episode: told every result; returns whether to go on.
        """
        while self.nothing_to_do(max_episodes, stop_at_schedule) is None:
            if not after_episode(self.episode()):
                return

    def close(self) -> None:
        """End the world."""
        self.walker.close()

    # -- checkpoints ---------------------------------------------------------------

    def save(self, path: Path) -> None:
        """Write all that the run needs to go on bit for bit."""
        header = {
            "settings": to_mapping(self.settings),
            **self.session.header(),
            "robot_rng": self._robot_rng.bit_generator.state,
            "cpu_s": self.cpu_s,
            "walked_ticks": vars(self.walker.ticks),
            "versions": versions(),
            "notes": self.notes,
        }
        write_checkpoint(path, header, self.session.arrays())

    @classmethod
    def load(
        cls,
        path: Path,
        replay_bytes: int = DEFAULT_MEMORY_BYTES,
        make: MakeLearner = make_learner,
    ) -> TrainingRun:
        """Return the run of a checkpoint, ready for its next episode.

        Args:
            path: what `save` wrote.
            replay_bytes: memory for the replay of walks, 0 to compute them all.
            make: who has learned; by default whom the settings name.

        Raises:
            CheckpointError: the file is no usable checkpoint.
        """
        header, arrays = read_checkpoint(path)
        run = None
        try:
            with taking_over(path):
                settings = from_mapping(RunSettings, header["settings"])
                run = cls(settings, header["seed"], replay_bytes, make)
                run.session.restore(header, arrays)
                # A learner on ROS does not know the robot's generator, nor what was
                # computed and how long that took.
                if "robot_rng" in header:
                    run._robot_rng.bit_generator.state = header["robot_rng"]
                spent = msgspec.convert(header, _Spent)
                run.walker.ticks, run.cpu_s = spent.walked_ticks, spent.cpu_s
                run.written_by, run.notes = spent.versions, spent.notes
        except CheckpointError:
            if run is not None:
                run.close()
            raise
        return run

    def under(
        self, settings: RunSettings, replay_bytes: int = DEFAULT_MEMORY_BYTES
    ) -> TrainingRun:
        """Return a run that goes on with this memory under other settings.

        What was achieved was achieved under the old ones: the present subtask begins
        anew, or the first that is no shorter, and no frozen walk has succeeded yet.

        Args:
            settings: differ in what `memory_settings.with_changes` lets change.
            replay_bytes: memory for the replay of walks, 0 to compute them all.
        """
        run = TrainingRun(settings, self.seed, replay_bytes)
        walked = self.session.task.schedule.target_ticks
        targets = run.session.task.schedule.targets
        header = self.session.header()
        header["progress"] |= {
            "subtask": next(i for i, ticks in enumerate(targets) if ticks >= walked),
            "successes": 0,
            "t_err_estimate": None,
        }
        header["trial_due"] = False
        header["tally"] = header["tally"] | {"greedy_episodes": None}
        run.session.restore(header, self.session.arrays())
        run._robot_rng.bit_generator.state = self._robot_rng.bit_generator.state
        run.walker.ticks = replace(self.walker.ticks)
        run.cpu_s = self.cpu_s
        run.written_by = self.written_by
        run.setting_changes = changes_in_words(
            to_mapping(self.settings), to_mapping(settings)
        )
        return run

    def summary(self, memory_file: Path) -> dict[str, Any]:
        """Return the run's figures, for people and scripts."""
        session, tally = self.session, self.tally
        schedule = session.task.schedule
        return {
            "completed": self.learned,
            "schedule_complete": schedule.complete,
            "target_time_s": seconds(schedule.target_ticks),
            "episodes": self.episodes,
            "schedule_episodes": tally.schedule_episodes,
            "greedy_episodes": tally.greedy_episodes,
            "evaluations": tally.evaluations,
            "simulated_s": seconds(tally.simulated_ticks),
            "evaluation_s": seconds(tally.evaluation_ticks),
            "replay_off": self.replay_off,
            "computed_ticks": self.walker.ticks.computed,
            "replayed_ticks": self.walker.ticks.replayed,
            "cpu_s": round(self.cpu_s, 3),
            "figures": session.learner.figures(),
            "seed": self.seed,
            "settings": to_mapping(self.settings),
            "memory_sha256": session.memory_sha256(),
            "trajectory_sha256": tally.trajectories_sha256,
            "memory_file": str(memory_file),
        }


def versions() -> dict[str, str]:
    """Return the packages that are here whose version can change a walk's last bit."""
    found = {}
    for name in _PACKAGES:
        with suppress(PackageNotFoundError):  # an engine that is not used here
            found[name] = version(name)
    return found
