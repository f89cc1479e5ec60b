"""An episode that is given up leaves nothing behind."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.learner_node.xol.random_episodes import runs

from learner_node.problem import ActionSpace, Problem
from learner_node.q_lambda import QLambda, QLambdaSettings
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import XolSettings


def q_lambda(_, states, problem, rng):
    return QLambda(QLambdaSettings(exploration=0.3), states, problem, rng)


LEARNERS = pytest.mark.parametrize("kind", [XolAgent, q_lambda])


def feed(learner, calls):
    """Return the learner's answers."""
    answers = [getattr(learner, method)(*arguments) for method, arguments in calls]
    return [None if answer is None else np.array(answer).tolist() for answer in answers]


def episodes_of(calls):
    """The calls, episode by episode."""
    episodes, begun = [], []
    for call in calls:
        begun.append(call)
        if call[0] == "greedy":
            episodes.append(begun)
            begun = []
    return episodes


def give_up(learner, episode, length):
    """Begin an episode, and give it up after so many calls."""
    begun = [c for c in episode if c[0] not in ("finish_subtask", "finish_episode")]
    chance = learner.rng.bit_generator.state
    feed(learner, begun[: max(1, length)])
    learner.give_up_episode()
    learner.rng.bit_generator.state = chance


def content(learner):
    arrays = learner.memory()
    return {name: (a.dtype, a.shape, a.tobytes()) for name, a in arrays.items()}


@LEARNERS
@settings(deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow])
@given(run=runs(), data=st.data())
def test_what_comes_after_is_as_if_it_had_never_begun(kind, run, data):
    case, calls = run
    undisturbed, disturbed = case.learner(kind), case.learner(kind)
    episodes = episodes_of(calls)
    for episode in episodes:
        for _ in range(data.draw(st.integers(0, 2))):
            other = data.draw(st.sampled_from(episodes))
            give_up(disturbed, other, data.draw(st.integers(1, 20)))
        assert content(disturbed) == content(undisturbed)
        assert feed(disturbed, episode) == feed(undisturbed, episode)
    assert content(disturbed) == content(undisturbed)


@LEARNERS
def test_more_new_states_than_there_was_room_for_are_dropped(kind):
    problem = Problem(0, (1.0,), ActionSpace((3,)), (8.0, 4.0))
    states = StateSettings()
    learner = kind(XolSettings(), states, problem, np.random.default_rng(0))
    before = content(learner)
    visits = [("advance", (np.array([10.0 * n]),)) for n in range(200)]
    visits[0] = ("begin_episode", visits[0][1])
    give_up(
        learner, [call for visit in visits for call in (visit, ("choose", ()))], 400
    )
    assert content(learner) == before
