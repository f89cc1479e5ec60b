"""New records within an episode as successes."""

import gymnasium
import pytest
from gymnasium.spaces import Discrete

from biped_lab.record_env import RecordEnv


class Places(gymnasium.Env):
    """Is at the places of a list, one after the other; the last one ends it."""

    observation_space = Discrete(100)
    action_space = Discrete(2)

    def __init__(self, places):
        self.places = places

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.step_number = 0
        return 0, {}

    def step(self, action):
        self.step_number += 1
        return 0, 0.0, self.step_number == len(self.places), False, {"kept": 1}


def outcomes(places, fails):
    """Return what the steps of an episode mean; records at 1, 3, 5 and so on."""
    env = RecordEnv(
        Places(places), lambda env: env.places[env.step_number - 1], 1.0, 2.0, fails
    )
    env.reset()
    found = [env.step(0)[-1] for _ in places]
    assert all(info["kept"] == 1 for info in found)
    return env, [info["outcome"] for info in found]


def successes(told):
    return [outcome.counts for outcome in told]


def test_each_new_record_is_one_success():
    _, told = outcomes([0, 1, 2, 3, 3, 0], fails=True)
    assert successes(told) == [False, True, False, True, False, False]


def test_a_leap_over_several_records_is_one_success():
    _, told = outcomes([7, 7, 8, 9, 0], fails=True)
    assert successes(told) == [True, False, False, True, False]


def test_a_new_episode_has_its_own_records():
    env, _ = outcomes([1, 0], fails=True)
    env.reset()
    assert env.step(0)[-1]["outcome"].counts


@pytest.mark.parametrize(("fails", "end"), [(True, (0, False)), (False, (None, True))])
def test_the_end_is_a_failure_or_a_success(fails, end):
    _, told = outcomes([0, 0], fails)
    assert (told[-1].penalty, told[-1].counts, told[-1].ended) == (*end, True)
    assert not told[0].ended
