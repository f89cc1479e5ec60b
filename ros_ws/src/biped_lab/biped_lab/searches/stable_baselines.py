"""PPO of Stable-Baselines3 (Raffin et al. 2021), through BipedWaist-v0; extra `sb3`.

No search, but another rival from outside; constants that are no options are the
library's defaults. It gets the inputs in units of the learner's widths, and a reward of
1 per decision that did not end the walk by a failure: the task's own comes at the end
only, where random walks never are. The target is the whole walk from the start.

    schedule    the first learning episode that walked the whole walk
    greedy      the first such after which the most likely actions walked it, too

PyTorch's state in the middle of an update is in no file: a resumed run learns anew up
to where it was, and is refused if that was not the same. Chance comes from the global
generators of PyTorch and NumPy, which the library seeds: one contestant per process.
"""

from __future__ import annotations

import hashlib
import sys
import threading
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import WalkedTicks
from biped_common.errors import BipedError
from biped_common.seeds import learner_stream
from biped_common.settings import Settings, setting, to_mapping
from biped_lab.contestant import Contestant, Entry, log_table
from biped_lab.waist_env import BipedWaistEnv
from learner_node.checkpoint import CheckpointError, read_checkpoint, write_checkpoint
from learner_node.memory import arrays_sha256
from learner_node.walking.episode_log import EpisodeLog
from learner_node.walking.task import End, WalkTask
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation

_FLAG = 10.0
_Step = tuple[NDArray[np.float64], float, bool, bool, dict[str, Any]]


@dataclass(frozen=True)
class PpoOptions(Settings):
    """Constants of PPO; as by default, they are the library's."""

    learning_rate: float = setting(3e-4, "", "of both networks", above=0.0)
    decisions: int = setting(2048, "decisions", "from one update to the next", lower=64)


class MissingExtraError(BipedError, ImportError):
    """What an extra of the distribution would bring is not installed."""


class _Closed(Exception):  # noqa: N818 - no error: it ends the thread
    """Nobody waits for the next episode any more."""


class _NotedTask(WalkTask):
    """The task, keeping the result of the last walk."""

    result: EpisodeResult

    def end(self, observation: Observation) -> End | None:
        """Take an observation into account; return how the walk ended, if it has."""
        end = super().end(observation)
        if end is not None:
            self.result = end.result
        return end


class _EpisodeGate(gymnasium.Wrapper[Any, Any, Any, Any]):
    """What PPO sees, and a gate at which it waits until an episode is wanted.

    The library learns in one call, in a thread of its own; it meets the gate at every
    reset.
    """

    def __init__(self, env: BipedWaistEnv) -> None:
        """Scale the inputs by the learner's widths."""
        super().__init__(env)
        task = env.task
        self._scale = np.array((_FLAG, _FLAG, *task.problem.radii))
        space = env.observation_space
        assert isinstance(space, gymnasium.spaces.Box)
        self.observation_space = gymnasium.spaces.Box(
            space.low / self._scale, space.high / self._scale, dtype=np.float64
        )
        self._wanted, self._waits = threading.Semaphore(0), threading.Semaphore(0)
        self._closed = False
        self._failure: BaseException | None = None

    def learn(self, model: Any) -> None:
        """Let PPO learn until the gate is closed; runs in a thread."""
        try:
            model.learn(total_timesteps=sys.maxsize)
        except _Closed:
            pass
        except BaseException as failure:
            self._failure = failure  # raised where the episode was wanted
        finally:
            self._waits.release()

    def wait(self) -> None:
        """Wait until PPO stands at the gate."""
        self._waits.acquire()
        if self._failure is not None:
            raise self._failure

    def pass_one(self) -> None:
        """Let one episode pass."""
        self._wanted.release()
        self.wait()

    def end(self) -> None:
        """Let nobody pass any more."""
        self._closed = True
        self._wanted.release()

    def scaled(self, inputs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the (8,) inputs in units of the learner's widths."""
        scaled: NDArray[np.float64] = inputs / self._scale
        return scaled

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float64], dict[str, Any]]:
        """Wait at the gate, then begin a walk."""
        self._waits.release()
        self._wanted.acquire()
        if self._closed:
            raise _Closed
        inputs, info = self.env.reset(seed=seed, options=options)
        return self.scaled(inputs), info

    def step(self, action: NDArray[np.int64]) -> _Step:
        """Walk until the next decision; 1 for every one but a failure."""
        inputs, _, terminated, truncated, info = self.env.step(action)
        failed = "penalty" in info
        return self.scaled(inputs), float(not failed), terminated, truncated, info


class PpoContestant:
    """Lets PPO learn episode by episode."""

    def __init__(self, settings: RunSettings, own: PpoOptions, seed: int) -> None:
        """Start from nothing.

        Raises:
            MissingExtraError: Stable-Baselines3 is not installed.
        """
        try:
            # Named as modules are, so that their versions are the run's.
            import stable_baselines3 as library
            import torch
            from stable_baselines3.common.logger import Logger
        except ImportError as error:
            raise MissingExtraError(
                "contestant 'stable_baselines': needs the extra sb3, "
                f"pip install 'biped[sb3]' ({error})"
            ) from None
        torch.set_num_threads(1)
        self.settings = settings
        self.options = own
        self.ticks = WalkedTicks()
        self.cpu_s = 0.0
        self._env = BipedWaistEnv(settings=to_mapping(settings))
        learner = settings.learner
        whole = replace(learner.schedule, first_target_s=settings.gait.duration_s)
        self._task = self._env.task = _NotedTask(
            replace(learner, schedule=whole), settings.gait.walk_ticks
        )
        self._gate = _EpisodeGate(self._env)
        (draw,) = learner_stream(seed).generate_state(1)
        self._model = library.PPO(
            "MlpPolicy",
            self._gate,
            learning_rate=own.learning_rate,
            n_steps=own.decisions,
            seed=int(draw),
            device="cpu",
        )
        # Its own logger would leave a folder per model beside temporary files.
        self._model.set_logger(Logger(folder=None, output_formats=[]))
        self._log = EpisodeLog()
        self._trajectories_sha256 = ""
        self._evaluation_ticks = 0
        self._milestones: dict[str, int] = {}
        self._thread = threading.Thread(
            target=self._gate.learn, args=(self._model,), daemon=True
        )
        self._thread.start()
        self._gate.wait()

    @property
    def episodes(self) -> int:
        """Learning episodes so far."""
        return len(self._log)

    def episode(self) -> None:
        """Walk one more learning episode, and the frozen trial where one is due."""
        started = time.process_time()
        self._gate.pass_one()
        result = self._task.result
        self.ticks.computed += result.control_ticks
        self._log.append(result)
        self._trajectories_sha256 = hashlib.sha256(
            (self._trajectories_sha256 + result.trajectory_sha256).encode()
        ).hexdigest()
        if result.completed:
            self._milestones.setdefault("schedule", self.episodes)
            if "greedy" not in self._milestones and self._greedy_walk().completed:
                self._milestones["greedy"] = self.episodes
        self.cpu_s += time.process_time() - started

    def milestone(self, name: str) -> int | None:
        """Return the number of episodes when a milestone was reached."""
        return self._milestones.get(name)

    def table(self) -> dict[str, NDArray[Any]]:
        """Return one row per episode, by column; the reward is the task's own."""
        return log_table(self._log)

    def figures(self) -> dict[str, Any]:
        """Return hashes and times, the same in every run."""
        policy = self._model.policy.state_dict()
        return {
            "simulated_ticks": int(self._log.arrays()["control_ticks"].sum()),
            "evaluation_ticks": self._evaluation_ticks,
            "memory_sha256": arrays_sha256(
                {name: tensor.numpy() for name, tensor in policy.items()}
            ),
            "trajectory_sha256": self._trajectories_sha256,
        }

    def save(self, path: Path) -> None:
        """Write atomically how far it has come; the way there is learned anew."""
        header = {
            "settings": to_mapping(self.settings),
            "options": to_mapping(self.options),
            "trajectory_sha256": self._trajectories_sha256,
        }
        write_checkpoint(path, header, self._log.arrays())

    @classmethod
    def resume(
        cls, path: Path, settings: RunSettings, own: PpoOptions, seed: int
    ) -> PpoContestant:
        """Return the contestant that `save` wrote, learned anew.

        Raises:
            CheckpointError: the file is no checkpoint, or of another PPO, or the same
                was not learned.
            MissingExtraError: Stable-Baselines3 is not installed.
        """
        header, arrays = read_checkpoint(path)
        for name, now in (("settings", settings), ("options", own)):
            if header.get(name) != to_mapping(now):
                raise CheckpointError(f"{path}: it has other {name}")
        contestant = cls(settings, own, seed)
        try:
            for _ in arrays.get("control_ticks", ()):
                contestant.episode()
            if contestant._trajectories_sha256 != header.get("trajectory_sha256"):
                raise CheckpointError(f"{path}: learned anew, the walks are others")
        except BaseException:
            contestant.close()
            raise
        return contestant

    def close(self) -> None:
        """End the world."""
        self._gate.end()
        self._thread.join()
        self._env.close()

    def _greedy_walk(self) -> EpisodeResult:
        """Walk the most likely actions, while PPO waits at the gate."""
        inputs, _ = self._env.reset()
        over = False
        while not over:
            scaled = self._gate.scaled(inputs)
            action, _ = self._model.predict(scaled, deterministic=True)
            inputs, _, terminated, truncated, _ = self._env.step(action)
            over = terminated or truncated
        result = self._task.result
        self.ticks.computed += result.control_ticks
        self._evaluation_ticks += result.control_ticks
        return result


def _begin(settings: RunSettings, own: PpoOptions, seed: int) -> Contestant:
    return PpoContestant(settings, own, seed)


def _resume(
    path: Path, settings: RunSettings, own: PpoOptions, seed: int
) -> Contestant:
    return PpoContestant.resume(path, settings, own, seed)


ENTRY = Entry(PpoOptions, _begin, _resume, __name__)
