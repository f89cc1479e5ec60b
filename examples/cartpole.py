"""XoL learns Gymnasium's CartPole-v1: hold the pole up for 500 steps.

    python examples/cartpole.py [SEED]

A failure is a penalty for the last three decisions, every ten steps survived are a
reward. Learned is a mean of at least 475 steps over 20 episodes. Of the seeds 11 to 20
(the constants were chosen on others), eight got there within 1,000 episodes, after 634
in the median; 16 and 17 did not.
"""

import sys
from collections import deque

import gymnasium
import numpy as np

from biped_lab.gym_learning import GymTask, perform, practise, survival
from learner_node.methods import MethodSettings, make_learner
from learner_node.states import StateSettings
from learner_node.xol.settings import FixedModeSettings, XolSettings

RADII = (1.2, 1.0, 0.08, 0.8)  # cart [m], [m/s]; pole [rad], [rad/s]
SETTINGS = MethodSettings(
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
)


def main(seed: int = 11, most_episodes: int = 1000) -> int:
    """Learn, and show what was learned; exit status 1 if it was not."""
    task = GymTask(gymnasium.make("CartPole-v1"), survival(every=10), RADII)
    learner = make_learner(SETTINGS, task.problem, np.random.default_rng(seed))
    recent: deque[int] = deque(maxlen=20)
    for episode in range(1, most_episodes + 1):
        recent.append(practise(task, learner, seed=1000 * seed + episode - 1).steps)
        if episode % 50 == 0:
            print(f"episode {episode}: mean of 20: {np.mean(recent):.0f} steps")
        if len(recent) == recent.maxlen and np.mean(recent) >= 475.0:
            break
    greedy = [perform(task, learner, seed=90_000 + i).steps for i in range(20)]
    learned = np.mean(recent) >= 475.0
    print(f"{'learned' if learned else 'not learned'} after {episode} episodes")
    print(f"greedy: mean of 20: {np.mean(greedy):.0f} of 500 steps")
    return 0 if learned else 1


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
