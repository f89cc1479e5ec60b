"""Profit sharing, episodic and online: shares by hand, and one against the other."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.biped_lab.rivals.learners import OUTWEIGHS_ALL, new, q_of
from tests.learner_node.xol.lettered_states import Draws, at, take, walk
from tests.learner_node.xol.random_episodes import Case, seeded_calls

from biped_lab.rivals.episodic_ps import EpisodicProfitSharing, EpisodicSettings
from biped_lab.rivals.online_ps import OnlineProfitSharing, OnlineSettings
from learner_node.problem import ActionSpace, Problem
from learner_node.states import StateSettings
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import FixedModeSettings, XolSettings

EPISODIC = (EpisodicProfitSharing, EpisodicSettings)
ONLINE = (OnlineProfitSharing, OnlineSettings)
BOTH = pytest.mark.parametrize("kind", [EPISODIC, ONLINE], ids=["episodic", "online"])
GAMMA = 0.5  # a power of two: shares are exact


def told_what_to_take(kind, **settings):
    return new(kind, rng=Draws(), discount=GAMMA, base_weight=OUTWEIGHS_ALL, **settings)


@BOTH
def test_a_reward_is_shared_geometrically(kind):
    learner = told_what_to_take(kind)
    walk(learner, "ABC", "010")
    learner.reward(8.0, counts=True)
    learner.finish_episode()
    assert [q_of(learner, s) for s in "ABC"] == [[2, 0], [0, 4], [8, 0]]


@BOTH
def test_a_rule_that_was_taken_twice_gets_both_shares(kind):
    learner = told_what_to_take(kind)
    walk(learner, "ABA", "000")
    learner.reward(8.0, counts=True)
    assert q_of(learner, "A") == [8 + 2, 0]


@BOTH
def test_a_failed_episode_shares_nothing(kind):
    learner = told_what_to_take(kind)
    walk(learner, "AB", "01")
    learner.penalise(0)
    learner.finish_episode()
    walk(learner, "B", "0")
    learner.reward(8.0, counts=True)
    assert [q_of(learner, s) for s in "AB"] == [[0, 0], [8, 0]]


@BOTH
def test_what_earned_more_is_chosen_more_often(kind):
    learner = new(kind, base_weight=1.0)
    for _ in range(3):
        learner.begin_episode(at("A"))
        learner.choose()
    assert learner.q.max() == 0.0
    learner.q[0, 0] = 8.0, 0.0
    chosen = [learner.choose()[0] for _ in range(1000)]
    assert 0.85 < chosen.count(0) / 1000 < 0.95  # of 9 : 1


def test_an_episode_of_profit_sharing_ends_with_its_reward():
    learner = told_what_to_take(EPISODIC)
    walk(learner, "A", "0")
    learner.reward(8.0, counts=True)
    learner.advance(at("B"))
    take(learner, 1)
    learner.reward(8.0, counts=True)
    assert [q_of(learner, s) for s in "AB"] == [[8, 0], [0, 8]]


def test_what_has_left_the_queue_gets_nothing():
    learner = told_what_to_take(ONLINE, queue_length=2)
    walk(learner, "ABC", "010")
    learner.reward(8.0, counts=True)
    assert [q_of(learner, s) for s in "ABC"] == [[0, 0], [0, 4], [8, 0]]


EPISODES = st.lists(
    st.tuples(st.text("ABCDE", min_size=1, max_size=12), st.integers(0, 6)),
    min_size=1,
    max_size=15,
)
"""States in their order, and the reward's power of two; 0: failure."""


@given(episodes=EPISODES, seed=st.integers(0, 99))
@settings(deadline=None, max_examples=60)
def test_a_queue_longer_than_any_episode_is_no_different_from_the_episode(
    episodes, seed
):
    both = [
        new(
            kind,
            (3, 4),
            np.random.default_rng(seed),
            discount=GAMMA,
            base_weight=1.0,
        )
        for kind in (EPISODIC, ONLINE)
    ]
    for letters, power in episodes:
        for n, letter in enumerate(letters):
            for learner in both:
                (learner.advance if n else learner.begin_episode)(at(letter))
            assert both[0].choose().tolist() == both[1].choose().tolist()
        for learner in both:
            if power:
                learner.reward(2.0**power, counts=True)
            else:
                learner.penalise(0)
            learner.finish_episode()
        assert both[0].q.tolist() == both[1].q.tolist()


class NaiveOnline:
    """Section 3.2, word by word; a rule is in the queue if among the last decisions."""

    def __init__(self, length, gamma):
        self.length, self.gamma = length, gamma
        self.w, self.c, self.selected_last, self.decisions = {}, {}, {}, 0

    def select(self, rule):
        self.decisions += 1
        for other, decision in self.selected_last.items():
            if decision <= self.decisions - self.length:
                self.c[other] = 0.0
        self.c[rule] = self.c.get(rule, 0.0) + 1.0
        self.selected_last[rule] = self.decisions

    def reward(self, r):
        for rule, c in self.c.items():
            self.w[rule] = self.w.get(rule, 0.0) + r * c

    def step(self):
        for rule in self.c:
            self.c[rule] *= self.gamma


@given(
    letters=st.text("ABC", min_size=1, max_size=20),
    length=st.integers(1, 6),
    seed=st.integers(0, 99),
)
@settings(deadline=None, max_examples=60)
def test_it_is_the_queue_of_section_3_2(letters, length, seed):
    learner = new(
        ONLINE, (3,), np.random.default_rng(seed), discount=0.9, queue_length=length
    )
    naive = NaiveOnline(length, 0.9)
    for n, letter in enumerate(letters):
        (learner.advance if n else learner.begin_episode)(at(letter))
        if n:
            naive.step()
        naive.select((letter, int(learner.choose()[0])))
    learner.reward(8.0, counts=True)
    naive.reward(8.0)
    assert {s: q_of(learner, s) for s in letters} == {
        s: [naive.w.get((s, j), 0.0) for j in range(3)] for s in letters
    }


def test_it_is_xol_without_fixed_states_and_penalty_rules():
    constants = {"discount": 0.9, "queue_length": 8, "base_weight": 0.5}
    without = XolSettings(
        **constants,
        failure_reach=1,
        selection_memory=0,
        failure_threshold=1.0,
        fixed_mode=FixedModeSettings(strategy="none"),
    )
    problem = Problem(1, (1.0,), ActionSpace((3, 5)), (8.0, 4.0, 2.0))
    case = Case(without, StateSettings(life_episodes=1000), problem, seed=3)
    xol = case.learner(XolAgent)
    online = case.learner(
        lambda _, *rest: OnlineProfitSharing(OnlineSettings(**constants), *rest)
    )
    for method, arguments in seeded_calls(case, np.random.default_rng(1)):
        if method != "greedy":  # there, P breaks ties
            answers = [getattr(who, method)(*arguments) for who in (xol, online)]
            assert np.array_equal(*answers)
    assert online.states.count == xol.states.count
    assert np.array_equal(online.q, xol.rules.q)
    assert online.q.any()
