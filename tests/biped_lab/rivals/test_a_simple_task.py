"""All rivals that learn learn a task of three choices, one after the other."""

import numpy as np
import pytest
from tests.biped_lab.rivals.learners import RIVALS, one_input

from learner_node.states import StateSettings

TARGETS = [(1, 0), (0, 0), (1, 1)]
"""What has to be chosen in three places, one after the other."""


def practise(learner):
    """One episode: a wrong choice fails, the last right one is rewarded."""
    for place, target in enumerate(TARGETS):
        inputs = np.array([10.0 * place])
        (learner.advance if place else learner.begin_episode)(inputs)
        if learner.choose().tolist() != list(target):
            learner.penalise(0)
            break
    else:
        learner.reward(100.0, counts=True)
    learner.finish_episode()


@pytest.mark.parametrize("name", [name for name in RIVALS if name != "random"])
def test_a_simple_task_is_learned(name):
    learner = RIVALS[name](
        StateSettings(life_episodes=10_000), one_input((2, 2)), np.random.default_rng(1)
    )
    for _ in range(600):
        practise(learner)
    answers = [learner.greedy(np.array([10.0 * n])) for n in range(len(TARGETS))]
    assert [tuple(answer.tolist()) for answer in answers] == TARGETS
