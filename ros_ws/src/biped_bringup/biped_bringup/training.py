"""A training run: episodes until the walk is learned, with checkpoints in between."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from biped_bringup.episode_log import EpisodeLog
from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import Walker
from learner_node.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from learner_node.walking.frozen import greedy_walk
from learner_node.walking.learner import WalkLearner
from msgs_json.episode_result import EpisodeResult
from msgs_json.settings import SettingsError, from_mapping, to_mapping
from msgs_json.timing import seconds

# Packages whose version can change a walk's last bit.
_PACKAGES = ("biped", "numpy", "numba", "pybullet")


@dataclass
class Tally:
    """Counts of a run, the part of a checkpoint that is neither memory nor schedule."""

    simulated_ticks: int = 0
    """Control ticks of all learning episodes."""
    evaluation_ticks: int = 0
    """Control ticks of all frozen greedy walks."""
    evaluations: int = 0
    schedule_episodes: int | None = None
    """Episodes when the schedule was complete."""
    greedy_episodes: int | None = None
    """Episodes when a frozen greedy walk first succeeded."""
    cpu_s: float = 0.0
    trajectories_sha256: str = ""
    """Chained over the learning episodes."""


class TrainingRun:
    """Learner, robot and bookkeeping of one run with one seed."""

    def __init__(self, settings: RunSettings, seed: int) -> None:
        """Start from nothing.

        Args:
            settings: of the whole run.
            seed: of every random draw; learner and disturbances have streams of their
                own.
        """
        learner_stream, robot_stream = np.random.SeedSequence(seed).spawn(2)
        self.settings = settings
        self.seed = seed
        self._robot_rng = np.random.default_rng(robot_stream)
        self.walker = Walker(settings, self._robot_rng)
        self.learner = WalkLearner(
            settings.learner,
            self.walker.walk_ticks,
            np.random.default_rng(learner_stream),
        )
        self.tally = Tally()
        self.log = EpisodeLog()

    # -- learning ------------------------------------------------------------------

    @property
    def episodes(self) -> int:
        """Learning episodes so far."""
        return len(self.log)

    @property
    def learned(self) -> bool:
        """Schedule complete, and a frozen greedy walk has succeeded."""
        return self.tally.greedy_episodes is not None

    def episode(self) -> EpisodeResult:
        """Walk one learning episode; then, once the schedule is through, try it frozen.

        The trial learns nothing. It follows only episodes that completed the walk: a
        learner that does not even complete it with chance on its side will not do so
        without.
        """
        started = time.process_time()
        result = self.walker.walk(self.learner, self.episodes + 1)
        tally = self.tally
        tally.simulated_ticks += result.control_ticks
        tally.trajectories_sha256 = hashlib.sha256(
            (tally.trajectories_sha256 + self.walker.biped.trajectory_sha256).encode()
        ).hexdigest()
        self.log.append(result)
        if result.schedule_complete:
            if tally.schedule_episodes is None:
                tally.schedule_episodes = self.episodes
            if result.completed and not self.learned:
                trial = self.greedy_walk()
                tally.evaluations += 1
                tally.evaluation_ticks += trial.control_ticks
                if trial.completed:
                    tally.greedy_episodes = self.episodes
        tally.cpu_s += time.process_time() - started
        return result

    def greedy_walk(self) -> EpisodeResult:
        """Walk the whole walk greedily, without learning."""
        frozen = greedy_walk(
            self.settings.learner, self.walker.walk_ticks, self.learner.agent
        )
        return self.walker.walk(frozen, episode=0)

    def run(
        self,
        max_episodes: int | None,
        stop_at_schedule: bool,
        after_episode: Callable[[EpisodeResult], bool],
    ) -> None:
        """Learn until the walk is learned.

        Args:
            max_episodes: give up then; None for no limit.
            stop_at_schedule: end with the schedule, as the paper does, whether or not
                the frozen greedy walk succeeds.
            after_episode: told every result; returns whether to go on.
        """
        while not self.learned:
            if stop_at_schedule and self.tally.schedule_episodes is not None:
                return
            if max_episodes is not None and self.episodes >= max_episodes:
                return
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
            "seed": self.seed,
            "progress": self.learner.progress(),
            "robot_rng": self._robot_rng.bit_generator.state,
            "tally": vars(self.tally),
            "versions": {name: version(name) for name in _PACKAGES},
        }
        arrays = {
            **{f"memory/{k}": v for k, v in self.learner.agent.memory().items()},
            **{f"log/{k}": v for k, v in self.log.arrays().items()},
        }
        write_checkpoint(path, header, arrays)

    @classmethod
    def load(cls, path: Path) -> TrainingRun:
        """Return the run of a checkpoint, ready for its next episode.

        Raises:
            CheckpointError: the file is no usable checkpoint.
        """
        header, arrays = read_checkpoint(path)
        groups: dict[str, dict[str, Any]] = {"memory": {}, "log": {}}
        try:
            for name, array in arrays.items():
                group, _, key = name.partition("/")
                groups[group][key] = array
            run = cls(from_mapping(RunSettings, header["settings"]), header["seed"])
            run.learner.restore(header["progress"], groups["memory"])
            run._robot_rng.bit_generator.state = header["robot_rng"]
            run.tally = Tally(**header["tally"])
            run.log = EpisodeLog(groups["log"])
        except (KeyError, TypeError, ValueError, SettingsError) as error:
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise CheckpointError(
                f"{path}: does not fit this program, {reason}"
            ) from error
        return run

    def summary(self, memory_file: Path) -> dict[str, Any]:
        """Return the run's figures, for people and scripts."""
        agent, tally = self.learner.agent, self.tally
        return {
            "completed": self.learned,
            "schedule_complete": self.learner.schedule.complete,
            "target_time_s": seconds(self.learner.schedule.target_ticks),
            "episodes": self.episodes,
            "schedule_episodes": tally.schedule_episodes,
            "greedy_episodes": tally.greedy_episodes,
            "evaluations": tally.evaluations,
            "simulated_s": seconds(tally.simulated_ticks),
            "evaluation_s": seconds(tally.evaluation_ticks),
            "cpu_s": round(tally.cpu_s, 3),
            "basis_states": agent.basis_states,
            "fixed_states": agent.fixed_states,
            "penalty_states": agent.penalty_states,
            "seed": self.seed,
            "memory_sha256": self.learner.memory_sha256(),
            "trajectory_sha256": tally.trajectories_sha256,
            "memory_file": str(memory_file),
        }
