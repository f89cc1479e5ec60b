"""Greedy use of what was learned."""

import copy

import numpy as np
import pytest
from tests.learner_node.xol.lettered_states import (
    at,
    make_penalty_state,
    new_agent,
    rewarded_walk,
    walk,
)

from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import XolSettings


def test_the_greedy_action_is_the_rewarded_one():
    agent = new_agent(n_alternatives=3)
    rewarded_walk(agent, "AB", "02")
    assert [agent.greedy(at(letter)).tolist() for letter in "AB"] == [[0], [2]]


def test_an_unknown_input_is_answered_by_the_nearest_state():
    agent = new_agent(n_alternatives=3)
    rewarded_walk(agent, "AB", "02")
    assert agent.greedy(at("Z")).tolist() == [2]


def test_an_agent_without_states_has_no_greedy_action():
    assert new_agent().greedy(at("A")) is None


def test_a_partition_without_states_has_no_greedy_action():
    problem = Problem(1, (1.0,), ActionSpace((2,)), (1.0, 1.0))
    rng = np.random.default_rng(0)
    agent = XolAgent(XolSettings(), StateSettings(), problem, rng)
    agent.begin_episode(np.array([10.0, 0.0]))
    assert agent.greedy(np.array([-10.0, 0.0])) is None


def test_a_penalty_state_has_a_greedy_action():
    agent = new_agent()
    make_penalty_state(agent, "A")
    assert agent.greedy(at("A")) is not None


def whole_state(agent):
    """All arrays and numbers of an agent in the midst of an episode."""
    queue, states = agent.queue, agent.states
    numbers = (agent.episode, agent.state, states.count, queue.head, queue.filled)
    arrays = (*agent.memory().values(), queue.eligibility, queue.states, queue.live)
    return copy.deepcopy((numbers, [array.tolist() for array in arrays]))


@pytest.mark.parametrize("letter", ("A", "B", "Z"))
def test_greedy_use_changes_nothing(letter):
    agent = new_agent()
    make_penalty_state(agent, "B")
    walk(agent, "AC", "01")
    before = whole_state(agent)
    agent.greedy(at(letter))
    assert whole_state(agent) == before


def test_greedy_use_draws_no_random_number():
    agent = new_agent()
    rewarded_walk(agent, "A", "0")
    agent.rng.coming = [0.5]
    agent.greedy(at("A"))
    assert agent.rng.coming == [0.5]


@pytest.mark.parametrize("action", [(0, 0, 0), (2, 0, 1), (1, 2, 2)])
def test_without_decomposition_joint_actions_are_learned(action):
    problem = Problem(0, (1.0,), ActionSpace((3, 3, 3)), (1.0, 1.0))
    rng = np.random.default_rng(0)
    agent = XolAgent(XolSettings(decomposed=False), StateSettings(), problem, rng)
    while True:
        agent.begin_episode(at("A"))
        if tuple(agent.choose()) == action:
            break
        agent.finish_episode()
    agent.reward(1.0, counts=True)
    assert tuple(agent.greedy(at("A"))) == action
