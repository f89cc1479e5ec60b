"""XoL learns Gymnasium's Acrobot-v1: swing the tip of a double pendulum up.

    python examples/acrobot.py [SEED]

Chance hardly ever gets there within the 500 steps. So each quarter of a link that the
tip gets higher in an episode is a reward, and so is the end, at the top. Learned is a
mean return of at least -200 over 20 episodes of the frozen policy, twice the time of
the environment's own threshold: two of the seeds 8201 to 8205 got there within 200
episodes. Who else learns it: docs/other-tasks.md.
"""

import sys

import gymnasium

from biped_lab.control_task import ControlTask, Environment, show
from biped_lab.gym_learning import rewarded
from biped_lab.record_env import RecordEnv
from learner_node.methods import MethodSettings
from learner_node.q_lambda import QLambdaSettings
from learner_node.states import StateSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings


def tip_height(env: Environment) -> float:
    """Return the height of the tip above the joint, in lengths of a link."""
    cos1, sin1, cos2, sin2 = env.unwrapped._get_ob()[:4]  # type: ignore[attr-defined]
    return float(-cos1 - (cos1 * cos2 - sin1 * sin2))


TASK = ControlTask(
    make=lambda: RecordEnv(
        gymnasium.make("Acrobot-v1"), tip_height, first=-1.75, rise=0.25, fails=False
    ),
    judge_of_values=rewarded,
    radii=(0.5, 0.5, 0.5, 0.5, 2.0, 4.0),  # cosines and sines; [rad/s] of the links
    goal=-200.0,
    best=0.0,
    most_episodes=200,
    settings=MethodSettings(
        states=StateSettings(life_episodes=1000),
        xol=XolSettings(
            discount=0.9,
            queue_length=20,
            failure_reach=1,
            base_weight=1.0,
            fixed_mode=FixedModeSettings(
                rewards_to_fix=50, counted="queue", patience_episodes=0
            ),
        ),
        q_lambda=QLambdaSettings(
            learning_rate=0.2, discount=1.0, trace_decay=0.9, exploration=0.0
        ),
    ),
)

if __name__ == "__main__":
    sys.exit(show(TASK, *map(int, sys.argv[1:] or ["8201"])))
