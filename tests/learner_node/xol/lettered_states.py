"""Agents that walk through states A, B, C, ... and take the alternatives they are told.

Every state is met at its own input, far from the others. The base weight outweighs all
rewards in the roulette, so that in a normal state the draw alone decides.
"""

from dataclasses import replace

import numpy as np

from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import FixedModeSettings, XolSettings

NEVER = 1000  # more than any count in these tests
DISCOUNT = 0.5  # a power of two: traces are exact
PENALTY_VALUES = (10.0, 20.0, 40.0)
P_NP = len(PENALTY_VALUES) - 1
SETTINGS = XolSettings(
    discount=DISCOUNT,
    queue_length=10,
    failure_reach=1,
    minimum_selections=1,
    selection_memory=0,
    base_weight=1e12,
    fixed_mode=FixedModeSettings(rewards_to_fix=NEVER, patience_episodes=0),
)


class Draws:
    """Stands in for a random generator; its numbers are told."""

    def __init__(self):
        self.coming = []

    def random(self, n):
        return np.array([self.coming.pop(0) for _ in range(n)])


def new_agent(n_alternatives=2, n_components=1, fixed_mode=None, **changes):
    """An agent for one continuous input and three kinds of penalty."""
    if fixed_mode is not None:
        changes["fixed_mode"] = replace(SETTINGS.fixed_mode, **fixed_mode)
    return XolAgent(
        replace(SETTINGS, **changes),
        StateSettings(),
        Problem(
            0, (1.0,), ActionSpace((n_alternatives,) * n_components), PENALTY_VALUES
        ),
        Draws(),
    )


def at(letter):
    """The input of a state."""
    return np.array([10.0 * (ord(letter) - ord("A"))])


def index(agent, letter):
    """The agent's number of a state."""
    return agent.states.find(at(letter), create=False)


def take(agent, *alternatives):
    """Choose, with draws that make these the choice where all are equally likely."""
    n = agent.problem.space.alternatives[0]
    agent.rng.coming = [(j + 0.5) / n for j in alternatives]
    chosen = tuple(agent.choose().tolist())
    assert chosen == alternatives


def take_any(agent):
    """Choose, whatever comes."""
    agent.rng.coming = [0.5] * agent.rules.space.table_shape[0]
    agent.choose()


def walk(agent, letters, taken):
    """Begin an episode and visit these states, taking an alternative in each.

    `taken` is a digit per state, or the alternatives of all components.
    """
    for place, (letter, alternatives) in enumerate(zip(letters, taken, strict=True)):
        if place == 0:
            agent.begin_episode(at(letter))
        else:
            agent.advance(at(letter))
        take(agent, *(int(j) for j in alternatives))


def rewarded_walk(agent, letters, taken, value=1.0, counts=True, whole_task=False):
    """Walk, be rewarded, and end the episode."""
    walk(agent, letters, taken)
    agent.reward(value, counts, whole_task)
    agent.finish_episode()


def failed_walk(agent, letters, taken, penalty=0):
    """Walk, pay a penalty, and end the episode."""
    walk(agent, letters, taken)
    agent.penalise(penalty)
    agent.finish_episode()


def make_penalty_state(agent, letter, penalty=0):
    """Fail with every alternative of a state."""
    for j in range(agent.problem.space.alternatives[0]):
        failed_walk(agent, letter, str(j), penalty)
    assert is_penalty_state(agent, letter)


def is_penalty_state(agent, letter):
    return bool(agent.rules.penalty_state[index(agent, letter)])


def is_fixed(agent, letter):
    return bool(agent.rules.fixed[index(agent, letter)])


def fixed_letters(agent, letters):
    return "".join(letter for letter in letters if is_fixed(agent, letter))


def rewards_of(agent, letter):
    """TUC."""
    return int(agent.rules.rewards[index(agent, letter)])


def q_of(agent, letter):
    return agent.rules.q[index(agent, letter), 0].tolist()


def p_of(agent, letter, penalty):
    return agent.rules.p[index(agent, letter), penalty, 0].tolist()


def failures_of(agent, letter, penalty):
    return agent.rules.failures[index(agent, letter), penalty, 0].tolist()


def selections_of(agent, letter):
    return agent.rules.selections[index(agent, letter), 0].tolist()
