"""Q(lambda) learns to balance the bicycle of Randløv and Alstrøm (1998).

    python examples/bicycle.py [SEED]

XoL does not, with the constants below (docs/other-tasks.md). A fall is a penalty, and
every 50 steps survived are a reward, but for the first, which any ride survives.
Learned is a mean of at least 950 of 1,000 steps, 10 s, over 20 episodes of the frozen
policy.
"""

import sys

import gymnasium

from biped_lab.control_task import ControlTask, show
from biped_lab.gym_learning import survival
from learner_node.methods import MethodSettings
from learner_node.q_lambda import QLambdaSettings
from learner_node.states import StateSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings

TASK = ControlTask(
    make=lambda: gymnasium.make("biped_lab:BicycleBalance-v0"),
    judge=survival(every=50, first=150),
    # Handlebars [rad], [rad/s]; tilt [rad], [rad/s], [rad/s^2]: this one not looked at.
    radii=(0.3, 2.0, 0.05, 0.25, 100.0),
    goal=950.0,
    best=1000.0,
    most_episodes=500,
    settings=MethodSettings(
        method="q_lambda",
        states=StateSettings(life_episodes=1000),
        xol=XolSettings(
            discount=0.97,
            queue_length=100,
            failure_reach=50,
            failure_threshold=0.8,
            base_weight=0.03,
            fixed_mode=FixedModeSettings(
                rewards_to_fix=80, counted="queue", patience_episodes=0
            ),
        ),
        q_lambda=QLambdaSettings(
            learning_rate=0.5, discount=0.99, trace_decay=0.95, exploration=0.0
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(show(TASK, *map(int, sys.argv[1:] or ["8201"])))
