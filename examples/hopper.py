"""XoL learns Gymnasium's Hopper-v5 to come half a metre forward before it falls.

    python examples/hopper.py [SEED]

Needs the extra `mujoco`. Each torque is at its least, zero or at its most. A fall is a
penalty for the last ten decisions, each new decimetre in an episode a reward. Learned
is a mean of at least 0.5 m, within 400 steps (3.2 s), over 20 episodes of the frozen
policy: no hopping. Of the seeds 8201 to 8205 the first got there within 300 episodes.
Who else learns it: docs/other-tasks.md.
"""

import sys

import gymnasium
import numpy as np
from gymnasium.spaces import MultiDiscrete
from gymnasium.wrappers import TransformAction

from biped_lab.control_task import ControlTask, Environment, show
from biped_lab.record_env import RecordEnv
from learner_node.methods import MethodSettings
from learner_node.q_lambda import QLambdaSettings
from learner_node.states import StateSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings


def distance_m(env: Environment) -> float:
    """Return how far the torso has come."""
    return float(env.unwrapped.data.qpos[0])  # type: ignore[attr-defined]


def hopper() -> Environment:
    """Return the environment with torques, continuous."""
    return gymnasium.make("Hopper-v5", max_episode_steps=400)


def three_torques() -> Environment:
    """Return it with three alternatives per torque, and judged by its progress."""
    env: Environment = TransformAction(
        hopper(), lambda chosen: np.asarray(chosen) - 1.0, MultiDiscrete([3, 3, 3])
    )
    return RecordEnv(env, distance_m, first=0.1, rise=0.1, fails=True)


TASK = ControlTask(
    make=three_torques,
    make_continuous=hopper,
    # Height [m], torso and joints [rad]; [m/s] twice, [rad/s].
    radii=(0.1, 0.1, 0.25, 0.25, 0.35, 1.0, 1.0, 2.0, 3.0, 3.0, 4.0),
    score=distance_m,
    goal=0.5,
    best=16.0,  # 3.2 s at 5 m/s
    most_episodes=300,
    settings=MethodSettings(
        states=StateSettings(life_episodes=1000),
        xol=XolSettings(
            discount=0.97,
            queue_length=60,
            failure_reach=10,
            base_weight=0.1,
            fixed_mode=FixedModeSettings(
                rewards_to_fix=5, counted="queue", patience_episodes=0
            ),
        ),
        q_lambda=QLambdaSettings(
            learning_rate=0.5, discount=0.99, trace_decay=0.95, exploration=0.0
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(show(TASK, *map(int, sys.argv[1:] or ["8201"])))
