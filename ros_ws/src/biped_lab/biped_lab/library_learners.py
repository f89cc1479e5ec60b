"""PPO and SAC of Stable-Baselines3 (Raffin et al. 2021) on a `ControlTask`.

Needs the extra `sb3`. Constants are the library's defaults, on the environment's own
observations and reward.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

import numpy as np

from biped_lab.control_task import ControlTask, Learned, good_enough
from biped_lab.searches.stable_baselines import MissingExtraError


def learn(task: ControlTask, algorithm: str, seed: int) -> Learned:
    """Let one of the library's algorithms learn until its policy is good enough.

    The policy is tried as a learner's is, but not twice between two updates.

    Args:
        task: what is learned, with the environment's own actions where it has some.
        algorithm: `PPO` or `SAC`.
        seed: of the algorithm and of the environments.

    Raises:
        MissingExtraError: Stable-Baselines3 is not installed.
    """
    try:
        library = importlib.import_module("stable_baselines3")
        logger = importlib.import_module("stable_baselines3.common.logger")
        torch = importlib.import_module("torch")
    except ImportError as error:
        raise MissingExtraError(
            f"{algorithm}: needs the extra sb3, pip install 'biped[sb3]' ({error})"
        ) from None
    torch.set_num_threads(1)
    of_learning, of_trials = np.random.SeedSequence(seed).generate_state(2).tolist()
    make = task.make_continuous or task.make
    trials = make()
    trials.reset(seed=of_trials)
    kind = {"PPO": library.PPO, "SAC": library.SAC}[algorithm]
    model = kind("MlpPolicy", make(), seed=of_learning, device="cpu")
    # Its own logger would leave a folder per model beside temporary files.
    model.set_logger(logger.Logger(folder=None, output_formats=[]))

    def trial() -> float:
        seen, _ = trials.reset()
        total, over = 0.0, False
        while not over:
            action, _ = model.predict(seen, deterministic=True)
            seen, reward, terminated, truncated, _ = trials.step(action)
            total, over = total + float(reward), terminated or truncated
        return total if task.score is None else task.score(trials)

    episodes, reached, due, tried = 0, False, False, 0

    def go_on(frame: dict[str, Any], _: dict[str, Any]) -> bool:
        """Count the episodes, and try the policy; the library calls it at each step."""
        nonlocal episodes, reached, due, tried
        if not frame["dones"][0]:
            return True
        episodes += 1
        due = due or episodes % task.check_every == 0
        if due and model._n_updates != tried:
            due, tried = False, model._n_updates
            reached = good_enough(task, trial)
        return not reached and episodes < task.most_episodes

    model.learn(total_timesteps=sys.maxsize, callback=go_on)
    return Learned(reached, episodes, int(model.num_timesteps))
