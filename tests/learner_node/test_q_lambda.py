"""Q(lambda): updates by hand, and the calls of a learner."""

import numpy as np
import pytest

from learner_node.problem import ActionSpace, Problem
from learner_node.q_lambda import QLambda, QLambdaSettings
from learner_node.states import StateSettings

ALPHA, GAMMA, LAMBDA = 0.5, 0.5, 0.5
PENALTY_VALUES = (8.0, 4.0, 2.0)


def new_learner(alternatives=(3,), seed=0, **changes):
    constants = {
        "learning_rate": ALPHA,
        "discount": GAMMA,
        "trace_decay": LAMBDA,
        "exploration": 0.0,
    }
    return QLambda(
        QLambdaSettings(**{**constants, **changes}),
        StateSettings(),
        Problem(0, (1.0,), ActionSpace(alternatives), PENALTY_VALUES),
        np.random.default_rng(seed),
    )


def at(letter):
    """The input of a state, far from those of the others."""
    return np.array([10.0 * (ord(letter) - ord("A"))])


def visit(learner, letters):
    """Begin an episode and choose once in each of these states."""
    chosen = []
    for place, letter in enumerate(letters):
        if place == 0:
            learner.begin_episode(at(letter))
        else:
            learner.advance(at(letter))
        chosen.append(learner.choose().tolist())
    return chosen


def q_of(learner, letter):
    return learner.q[learner.states.find(at(letter), create=False), 0].tolist()


def test_where_nothing_is_known_the_middle_is_chosen():
    assert visit(new_learner((3, 5)), "A") == [[1, 2]]


def test_a_reward_raises_the_value_of_what_was_chosen():
    learner = new_learner()
    visit(learner, "A")
    learner.reward(16.0, counts=True)
    learner.finish_episode()
    assert q_of(learner, "A") == [0.0, ALPHA * 16.0, 0.0]


def test_a_penalty_lowers_it():
    learner = new_learner()
    visit(learner, "A")
    learner.penalise(1)
    learner.finish_episode()
    assert q_of(learner, "A") == [0.0, -ALPHA * 4.0, 0.0]


def test_what_was_chosen_before_gets_a_share_by_its_trace():
    learner = new_learner()
    visit(learner, "AB")
    learner.reward(16.0, counts=True)
    learner.finish_episode()
    assert q_of(learner, "B")[1] == ALPHA * 16.0
    assert q_of(learner, "A")[1] == ALPHA * 16.0 * GAMMA * LAMBDA


def test_a_move_to_a_better_state_is_worth_its_discounted_value():
    learner = new_learner(trace_decay=0.0)
    visit(learner, "B")
    learner.reward(16.0, counts=True)
    learner.finish_episode()
    visit(learner, "AB")
    assert q_of(learner, "A")[1] == ALPHA * GAMMA * ALPHA * 16.0


def test_an_end_without_reward_or_penalty_teaches_nothing():
    learner = new_learner()
    visit(learner, "A")
    learner.finish_episode()
    assert not learner.q.any()


def test_an_exploratory_choice_cuts_the_traces_of_its_component():
    learner = new_learner((3, 3), exploration=1.0)
    visit(learner, "AB")
    learner.reward(16.0, counts=True)
    learner.finish_episode()
    a = learner.states.find(at("A"), create=False)
    assert not learner.q[a].any()


def test_all_alternatives_of_all_components_are_explored():
    learner = new_learner((2, 4), exploration=1.0)
    chosen = visit(learner, "A" * 200)
    assert [set(component) for component in zip(*chosen, strict=True)] == [
        {0, 1},
        {0, 1, 2, 3},
    ]


def test_the_greedy_action_is_the_best_and_changes_nothing():
    learner = new_learner()
    visit(learner, "A")
    learner.penalise(0)
    learner.finish_episode()
    before = learner.memory(), learner.rng.bit_generator.state
    assert learner.greedy(at("A")).tolist() == [0]
    assert learner.rng.bit_generator.state == before[1]
    assert all(np.array_equal(v, before[0][k]) for k, v in learner.memory().items())


def test_without_a_state_there_is_no_greedy_action():
    assert new_learner().greedy(at("A")) is None


def test_only_penalties_of_the_environment_can_be_given():
    learner = new_learner()
    visit(learner, "A")
    with pytest.raises(ValueError, match="penalty = 2"):
        learner.penalise(2)


def practise(learner, rng, episodes):
    """Reach one of many states at random, with whatever end."""
    for _ in range(episodes):
        visit(learner, rng.choice(list("ABCDEFGH"), 4))
        if rng.random() < 0.5:
            learner.reward(100.0, counts=True)
        else:
            learner.penalise(0)
        learner.finish_episode()


def test_a_restored_learner_goes_on_as_if_never_interrupted():
    learner, restored = new_learner(exploration=0.3), new_learner(exploration=0.3)
    practise(learner, np.random.default_rng(1), 30)
    restored.restore(learner.memory())
    restored.rng.bit_generator.state = learner.rng.bit_generator.state
    for each in (learner, restored):
        practise(each, np.random.default_rng(2), 30)
    memory = restored.memory()
    assert all(np.array_equal(v, memory[k]) for k, v in learner.memory().items())


def test_a_memory_of_another_problem_is_refused():
    learner = new_learner((3,))
    visit(learner, "A")
    with pytest.raises(ValueError, match="array q is"):
        new_learner((4,)).restore(learner.memory())


def test_unused_states_without_promise_are_forgotten():
    learner = QLambda(
        QLambdaSettings(),
        StateSettings(life_episodes=1),
        Problem(0, (1.0,), ActionSpace((3,)), PENALTY_VALUES),
        np.random.default_rng(0),
    )
    for letter in "ABB":
        visit(learner, letter)
        learner.penalise(0)
        learner.finish_episode()
    assert learner.figures()["basis_states"] == 1
