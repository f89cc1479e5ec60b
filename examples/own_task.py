"""A task of one's own: XoL learns to stop a cart at a mark, without Gymnasium.

    python examples/own_task.py [SEED]

The cart stands 0.8 m left of the mark, on a rail that ends 1 m from it on either side.
Running off the rail is a penalty, standing at the mark a reward. Of the seeds 11 to 30
(the constants were chosen on others), 16 stop the cart after 100 rides; 21, 22, 26
and 29 do not, once chance is switched off.
"""

import sys

import numpy as np

from learner_node.learner import GOING_ON, Learner, Outcome, tell
from learner_node.methods import MethodSettings, make_learner
from learner_node.problem import ActionSpace, Problem
from learner_node.xol.settings import XolSettings

ACCELERATIONS = (-0.4, 0.0, 0.4)  # [m/s^2]
PERIOD_S = 0.2
PROBLEM = Problem(
    n_discrete=0,
    radii=(0.15, 0.15),  # position [m], velocity [m/s]
    space=ActionSpace((len(ACCELERATIONS),)),
    penalty_values=(10.0, 10.0),  # off the rail; moving to a penalty state
)
SETTINGS = MethodSettings(
    xol=XolSettings(discount=0.9, queue_length=30, failure_reach=5, base_weight=10.0)
)


class Cart:
    """Position and velocity from the mark, and how often the cart was pushed."""

    def __init__(self) -> None:
        self.inputs = np.array([-0.8, 0.0])
        self.decisions = 0

    def push(self, chosen: int) -> Outcome:
        """Accelerate for one period; say what came of it, in a learner's terms."""
        position, velocity = self.inputs
        velocity += PERIOD_S * ACCELERATIONS[chosen]
        position += PERIOD_S * velocity
        self.inputs = np.array([position, velocity])
        self.decisions += 1
        if abs(position) > 1.0:
            return Outcome(penalty=0, ended=True)
        if abs(position) < 0.1 and abs(velocity) < 0.1:
            return Outcome(reward=100.0, counts=True, ended=True)
        return Outcome(ended=True) if self.decisions == 100 else GOING_ON


def practise(learner: Learner) -> None:
    """Learn from one ride."""
    cart, outcome = Cart(), GOING_ON
    learner.begin_episode(cart.inputs)
    while not outcome.ended:
        outcome = cart.push(int(learner.choose()[0]))
        tell(learner, outcome)
        if not outcome.ended:
            learner.advance(cart.inputs)


def main(seed: int = 11) -> int:
    """Learn, then ride without chance; exit status 1 if the mark is missed."""
    learner = make_learner(SETTINGS, PROBLEM, np.random.default_rng(seed))
    for _ in range(100):
        practise(learner)
    cart, outcome = Cart(), GOING_ON
    while not outcome.ended:
        chosen = learner.greedy(cart.inputs)
        outcome = cart.push(1 if chosen is None else int(chosen[0]))
    end = "stops at the mark" if outcome.counts else "misses the mark"
    print(f"after 100 rides: {end}, {PERIOD_S * cart.decisions:.1f} s")
    return 0 if outcome.counts else 1


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
