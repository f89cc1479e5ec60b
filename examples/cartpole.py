"""XoL learns Gymnasium's CartPole-v1: hold the pole up for 500 steps.

    python examples/cartpole.py [SEED]

A failure is a penalty for the last three decisions, every ten steps survived are a
reward. Learned is a mean return of at least 475, the environment's own threshold, over
20 episodes of the frozen policy: within 500 episodes, three of the seeds 8201 to 8205
got there. Who else learns it: docs/other-tasks.md.
"""

import sys

import gymnasium

from biped_lab.control_task import ControlTask, show
from biped_lab.gym_learning import failing, survival
from learner_node.methods import MethodSettings
from learner_node.q_lambda import QLambdaSettings
from learner_node.states import StateSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings

TASK = ControlTask(
    make=lambda: gymnasium.make("CartPole-v1"),
    judge=survival(every=10),
    judge_of_values=failing,
    radii=(1.2, 1.0, 0.08, 0.8),  # cart [m], [m/s]; pole [rad], [rad/s]
    goal=475.0,
    best=500.0,
    most_episodes=500,
    settings=MethodSettings(
        states=StateSettings(life_episodes=1000),
        xol=XolSettings(
            discount=0.8,
            queue_length=10,
            failure_reach=3,
            minimum_selections=4,
            selection_memory=8,
            failure_threshold=0.35,
            base_weight=1.0,
            fixed_mode=FixedModeSettings(
                rewards_to_fix=40, counted="queue", patience_episodes=0
            ),
        ),
        q_lambda=QLambdaSettings(
            learning_rate=0.2, discount=0.98, trace_decay=0.8, exploration=0.0
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(show(TASK, *map(int, sys.argv[1:] or ["8201"])))
