"""SARSA(lambda): updates by hand."""

import numpy as np
from tests.biped_lab.rivals.learners import at, new, q_of

from biped_lab.rivals.sarsa_lambda import SarsaLambda, SarsaSettings

SARSA = (SarsaLambda, SarsaSettings)
ALPHA = GAMMA = LAMBDA = 0.5


class Told:
    """Stands in for a random generator: alternatives to explore, None for the best."""

    def __init__(self, *alternatives):
        self.coming = list(alternatives)

    def random(self, n):
        return np.full(n, 1.0 if self.coming[0] is None else 0.0)

    def integers(self, sizes):
        return np.full(len(sizes), self.coming.pop(0) or 0)


def sarsa(*told, alternatives=(3,), exploration=0.0, **changes):
    constants = {"learning_rate": ALPHA, "discount": GAMMA, "trace_decay": LAMBDA}
    if told:
        return new(SARSA, alternatives, Told(*told), exploration=0.5, **constants)
    return new(SARSA, alternatives, exploration=exploration, **constants, **changes)


def visit(learner, letters):
    """Begin an episode and choose once in each of these states."""
    for place, letter in enumerate(letters):
        (learner.advance if place else learner.begin_episode)(at(letter))
        learner.choose()


def rewarded(learner, letters, value=16.0):
    visit(learner, letters)
    learner.reward(value, counts=True)
    learner.finish_episode()


def middle(learner, letters):
    return [q_of(learner, letter)[1] for letter in letters]


def test_a_chain_of_three_states_by_hand():
    learner = sarsa()
    rewarded(learner, "ABC")
    # delta = 16 in C, traces 1/16, 1/4, 1
    assert middle(learner, "ABC") == [0.5, 2.0, 8.0]
    visit(learner, "AB")
    # delta = gamma 2 - 0.5 = 0.5 in A
    assert middle(learner, "AB") == [0.75, 2.0]
    learner.advance(at("C"))
    learner.choose()
    # delta = gamma 8 - 2 = 2 in B
    assert middle(learner, "ABC") == [1.0, 3.0, 8.0]
    learner.reward(16.0, counts=True)
    learner.finish_episode()
    # delta = 16 - 8 = 8 in C
    assert middle(learner, "ABC") == [1.25, 4.0, 12.0]


def test_a_move_is_worth_what_is_done_next_not_what_would_be_best():
    learner = sarsa(None, None, 0)
    rewarded(learner, "B")
    assert q_of(learner, "B") == [0.0, 8.0, 0.0]
    visit(learner, "AB")
    assert q_of(learner, "A") == [0.0, 0.0, 0.0]


def test_a_trace_is_replaced_and_those_of_the_other_alternatives_end():
    learner = sarsa(0, None, 2)
    rewarded(learner, "ABA")
    assert q_of(learner, "A") == [0.0, 0.0, 8.0]
    learner = sarsa(None, None, None)
    rewarded(learner, "ABA")
    assert q_of(learner, "A") == [0.0, 8.0, 0.0]


def test_a_penalty_is_a_negative_reward():
    learner = sarsa()
    visit(learner, "A")
    learner.penalise(1)
    learner.finish_episode()
    assert q_of(learner, "A") == [0.0, -ALPHA * 4.0, 0.0]
    assert learner.greedy(at("A")).tolist() == [0]


def test_an_end_without_reward_or_penalty_teaches_nothing():
    learner = sarsa()
    visit(learner, "A")
    learner.finish_episode()
    assert not learner.q.any()


def test_every_component_learns_from_its_own_error():
    learner = sarsa(alternatives=(3, 3))
    rewarded(learner, "A")
    learner.q[0, 1] = 0.0
    rewarded(learner, "A")
    assert learner.q[0].tolist() == [[0, 12, 0], [0, 8, 0]]
