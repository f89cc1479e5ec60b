"""All rivals keep what the Learner seam promises."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.biped_lab.rivals.learners import RIVALS, one_input
from tests.learner_node.test_given_up_episodes import (
    content,
    episodes_of,
    feed,
    give_up,
)
from tests.learner_node.xol.random_episodes import runs

from biped_lab.contestant import GROUP, entry_points
from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings

EACH = pytest.mark.parametrize("name", RIVALS)
SOME = settings(
    deadline=None, max_examples=15, suppress_health_check=[HealthCheck.too_slow]
)


def twins(name, case):
    """Two learners for a case that know the same: nothing."""
    return [case.learner(lambda _, *rest: RIVALS[name](*rest)) for _ in range(2)]


def test_these_are_all_contestants_that_are_registered():
    assert RIVALS.keys() <= entry_points(GROUP).keys()


@EACH
@SOME
@given(run=runs(), data=st.data())
def test_an_episode_that_is_given_up_leaves_nothing_behind(name, run, data):
    case, calls = run
    undisturbed, disturbed = twins(name, case)
    episodes = episodes_of(calls)
    for episode in episodes:
        for _ in range(data.draw(st.integers(0, 2))):
            other = data.draw(st.sampled_from(episodes))
            give_up(disturbed, other, data.draw(st.integers(1, 20)))
        assert content(disturbed) == content(undisturbed)
        assert feed(disturbed, episode) == feed(undisturbed, episode)
    assert content(disturbed) == content(undisturbed)
    assert disturbed.figures() == undisturbed.figures()


@EACH
@SOME
@given(run=runs(), data=st.data())
def test_a_restored_learner_goes_on_like_the_one_it_was_taken_from(name, run, data):
    case, calls = run
    ends = [n + 1 for n, call in enumerate(calls) if call[0] == "finish_episode"]
    interruption = data.draw(st.sampled_from(ends))
    first, second = twins(name, case)
    feed(second, calls[: data.draw(st.sampled_from(ends))])  # to be forgotten
    feed(first, calls[:interruption])
    second.restore(first.memory())
    second.rng.bit_generator.state = first.rng.bit_generator.state
    assert second.figures() == first.figures()
    rest = calls[interruption:]
    assert feed(first, rest) == feed(second, rest)
    assert content(first) == content(second)


@EACH
@SOME
@given(run=runs())
def test_a_greedy_choice_changes_nothing(name, run):
    case, calls = run
    learner, _ = twins(name, case)
    feed(learner, [call for call in calls if call[0] != "greedy"])
    before = content(learner), learner.rng.bit_generator.state
    inputs = [arguments[0] for method, arguments in calls if method == "advance"]
    for each in inputs:
        learner.greedy(each)
    assert (content(learner), learner.rng.bit_generator.state) == before


@EACH
def test_more_new_states_than_there_was_room_for_are_dropped(name):
    learner = RIVALS[name](StateSettings(), one_input(), np.random.default_rng(0))
    before = content(learner)
    visits = [("advance", (np.array([10.0 * n]),)) for n in range(200)]
    visits[0] = ("begin_episode", visits[0][1])
    calls = [call for visit in visits for call in (visit, ("choose", ()))]
    give_up(learner, calls, 400)
    assert content(learner) == before
    feed(learner, [*calls, ("reward", (1.0, True)), ("finish_episode", ())])


def experienced(name, problem=None):
    """A learner of three states, with a reward and a failure behind it."""
    learner = RIVALS[name](
        StateSettings(), problem or one_input((3, 5)), np.random.default_rng(0)
    )
    for end in (("reward", (1.0, True)), ("penalise", (0,))):
        learner.begin_episode(np.array([0.0]))
        for n in range(3):
            learner.choose()
            learner.advance(np.array([10.0 * n]))
        learner.choose()
        feed(learner, [end, ("finish_episode", ())])
    return learner


@EACH
def test_a_memory_with_an_array_missing_is_refused_by_its_name(name):
    learner = experienced(name)
    before = content(learner)
    for array in learner.memory():
        memory = learner.memory()
        del memory[array]
        with pytest.raises(ValueError, match=array):
            learner.restore(memory)
    assert content(learner) == before


@EACH
def test_a_memory_with_an_array_of_another_kind_is_refused_by_its_name(name):
    learner = experienced(name)
    before = content(learner)
    for array, values in learner.memory().items():
        for wrong in (values.astype(np.float32), values[None]):
            with pytest.raises(ValueError, match=array):
                learner.restore({**learner.memory(), array: wrong})
    assert content(learner) == before


def test_transitions_to_states_that_are_not_there_are_refused():
    learner = experienced("parp")
    memory = learner.memory()
    assert len(memory["transitions"]) > 0
    for wrong in (-1, 99):
        memory["transitions"][0, 3] = wrong
        with pytest.raises(ValueError, match="transitions"):
            learner.restore(memory)


@pytest.mark.parametrize("name", [name for name in RIVALS if name != "random"])
def test_a_memory_of_another_problem_is_refused(name):
    memory = experienced(name).memory()
    other = RIVALS[name](StateSettings(), one_input((3, 4)), np.random.default_rng(0))
    with pytest.raises(ValueError, match=r"memory: array (q|transitions)"):
        other.restore(memory)


@EACH
def test_a_penalty_that_the_task_cannot_give_is_refused(name):
    learner = experienced(name)
    learner.begin_episode(np.array([0.0]))
    learner.choose()
    with pytest.raises(ValueError, match="penalty = 2"):
        learner.penalise(2)


@EACH
def test_joint_actions_are_answered_by_their_components(name):
    problem = Problem(0, (1.0,), ActionSpace((2, 3), decomposed=False), (8.0, 4.0))
    learner = RIVALS[name](StateSettings(), problem, np.random.default_rng(0))
    learner.begin_episode(np.array([0.0]))
    chosen = {tuple(learner.choose().tolist()) for _ in range(300)}
    assert chosen == {(a, b) for a in range(2) for b in range(3)}
    greedy = learner.greedy(np.array([0.0]))
    assert greedy is None or greedy.shape == (2,)
