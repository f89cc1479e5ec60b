"""Learners on Gymnasium environments of every kind of space."""

import gymnasium
import numpy as np
import pytest
from gymnasium.spaces import Box, Dict, Discrete, MultiDiscrete

from biped_lab.gym_learning import (
    GymTask,
    Step,
    UnfitEnvironmentError,
    arrival,
    failing,
    perform,
    practise,
    rewarded,
    survival,
    told_by_info,
)
from learner_node.learner import GOING_ON, Outcome
from learner_node.methods import MethodSettings, make_learner
from learner_node.xol.settings import FixedModeSettings, XolSettings

SETTINGS = MethodSettings(
    xol=XolSettings(
        discount=0.8,
        queue_length=30,
        failure_reach=1,
        minimum_selections=4,
        selection_memory=0,
        base_weight=0.1,
        fixed_mode=FixedModeSettings(rewards_to_fix=5, patience_episodes=0),
    )
)


class Corridor(gymnasium.Env):
    """Go along a corridor of five rooms to its end; at the other end is a hole."""

    def __init__(self, observations, actions):
        self.observation_space = observations
        self.action_space = actions

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self._room = 2
        return self._seen(), {}

    def step(self, action):
        space = self.action_space
        forward = np.ravel(action - np.array(space.start))[0] == 1
        assert space.contains(action)
        self._room += 1 if forward else -1
        there, fell = self._room == 5, self._room < 0
        info = {"penalty": 0} if fell else {"outcome": ARRIVED} if there else {}
        return self._seen(), float(there), there or fell, False, info

    def _seen(self):
        if isinstance(self.observation_space, Discrete):
            return self._room
        return np.array([1.0, self._room], dtype=self.observation_space.dtype)


ARRIVED = Outcome(reward=1.0, counts=True, ended=True)
ROOMS = Discrete(6)
PLACES = Box(-1.0, 5.0, (2,), dtype=np.float32)
SPACES = {
    "Discrete, Discrete": (ROOMS, Discrete(2), ()),
    "Discrete, Discrete from 3": (ROOMS, Discrete(2, start=3), ()),
    "Discrete, MultiDiscrete": (ROOMS, MultiDiscrete([2, 3]), ()),
    "Box, Discrete": (PLACES, Discrete(2), (0.4, 0.4)),
    "Box whose first input is discrete": (PLACES, MultiDiscrete([2]), (0.4,)),
}


@pytest.mark.parametrize("method", ["xol", "q_lambda"])
@pytest.mark.parametrize(
    ("observations", "actions", "radii"), SPACES.values(), ids=SPACES
)
def test_the_way_along_a_corridor_is_learned(observations, actions, radii, method):
    task = GymTask(Corridor(observations, actions), radii=radii)
    settings = MethodSettings(method=method, xol=SETTINGS.xol)
    learner = make_learner(settings, task.problem, np.random.default_rng(0))
    for _ in range(200):
        practise(task, learner)
    assert perform(task, learner) == (3, 1.0)


def test_an_environment_of_gymnasiums_own_is_learned():
    env = gymnasium.make("FrozenLake-v1", is_slippery=False)
    task = GymTask(env, lake)
    rng = np.random.default_rng(0)
    learner = make_learner(SETTINGS, task.problem, rng)
    for _ in range(600):
        practise(task, learner)
    assert perform(task, learner).total_reward == 1.0


def lake(step):
    """A hole ends the episode without reward, which is a failure."""
    if step.terminated and step.reward == 0.0:
        return Outcome(penalty=0, ended=True)
    return arrival(step)


def test_performing_teaches_nothing():
    task = GymTask(Corridor(ROOMS, Discrete(2)))
    learner = make_learner(SETTINGS, task.problem, np.random.default_rng(0))
    perform(task, learner)
    assert learner.figures()["basis_states"] == 0


@pytest.mark.parametrize(
    ("observations", "actions", "radii", "named"),
    [
        (Dict({"a": ROOMS}), Discrete(2), (), "observation space Dict"),
        (Box(0.0, 1.0, (2, 2)), Discrete(2), (0.1,), "must be a Discrete or a Box"),
        (ROOMS, PLACES, (), "action space Box"),
        (ROOMS, MultiDiscrete([[2, 2]]), (), "action space MultiDiscrete"),
        (PLACES, Discrete(2), (0.1,) * 3, "radii: 3 given"),
        (ROOMS, Discrete(2), (0.1,), "radii: 1 given"),
    ],
)
def test_spaces_that_cannot_be_learned_are_refused(observations, actions, radii, named):
    with pytest.raises(UnfitEnvironmentError, match=named):
        GymTask(Corridor(observations, actions), radii=radii)


# -- judges ---------------------------------------------------------------------------


def step(number=1, terminated=False, truncated=False, **info):
    return Step(number, 0.0, terminated, truncated, info)


def test_an_environment_that_tells_its_outcome_is_believed():
    assert told_by_info(step(outcome=ARRIVED, penalty=0)) is ARRIVED


def test_a_penalty_in_the_info_is_a_failure():
    told = told_by_info(step(terminated=True, penalty=1))
    assert told == Outcome(penalty=1, ended=True)


def test_an_end_without_a_word_is_only_an_end():
    assert told_by_info(step(truncated=True)) == Outcome(ended=True)
    assert told_by_info(step()) == GOING_ON


def test_lasting_is_rewarded_every_so_often():
    judge = survival(every=3)
    rewards = [judge(step(number)).reward for number in range(1, 7)]
    assert rewards == [None, None, 1.0, None, None, 1.0]


def test_before_the_first_so_many_steps_lasting_is_no_success():
    judge = survival(every=2, first=5)
    assert [judge(step(number)).counts for number in (2, 4, 6)] == [False, False, True]


def test_where_only_failing_is_judged_lasting_is_nothing():
    ends = [
        failing(step(10)),
        failing(step(terminated=True)),
        failing(step(truncated=True)),
    ]
    assert [(end.penalty, end.reward, end.ended) for end in ends] == [
        (None, None, False),
        (0, None, True),
        (None, None, True),
    ]


def test_the_environments_own_reward_is_never_a_success():
    told = rewarded(Step(1, -1.0, True, False, {}))
    assert told == Outcome(reward=-1.0, ended=True)


def test_not_lasting_is_a_failure():
    told = survival(every=3)(step(3, terminated=True))
    assert told == Outcome(penalty=0, ended=True)


def test_lasting_to_the_end_is_rewarded():
    told = survival(every=3)(step(4, truncated=True))
    assert told == Outcome(reward=1.0, counts=True, ended=True)


def test_arriving_is_rewarded_and_being_late_is_not():
    assert arrival(step(terminated=True)) == ARRIVED
    assert arrival(step(truncated=True)) == Outcome(ended=True)
