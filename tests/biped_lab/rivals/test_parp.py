"""PARP: who is a penalty rule, by hand and by brute force, and what follows from it."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.biped_lab.rivals.learners import OUTWEIGHS_ALL, at, new

from biped_lab.rivals.parp import Parp, ParpSettings

PARP = (Parp, ParpSettings)


def visit(learner, letters):
    """Begin an episode and choose once in each of these states; return the choices."""
    chosen = []
    for place, letter in enumerate(letters):
        (learner.advance if place else learner.begin_episode)(at(letter))
        chosen.append(tuple(learner.choose().tolist()))
    return chosen


def fail(learner, letters, times=1):
    for _ in range(times):
        visit(learner, letters)
        learner.penalise(0)
        learner.finish_episode()


def penalty_states(learner, letters):
    found = [learner.states.find(at(letter), create=False) for letter in letters]
    return "".join(
        letter
        for letter, k in zip(letters, found, strict=True)
        if learner.penalty_states[k]
    )


def test_one_failure_makes_a_penalty_rule_and_it_is_not_chosen_again():
    learner = new(PARP, (4,))
    chosen = []
    for _ in range(4):
        chosen += visit(learner, "A")
        learner.penalise(0)
        learner.finish_episode()
    assert sorted(chosen) == [(0,), (1,), (2,), (3,)]
    assert penalty_states(learner, "A") == "A"


def test_rules_that_lead_to_a_penalty_state_are_penalty_rules():
    learner = new(PARP, (2,))
    fail(learner, "B", times=2)
    visit(learner, "AB")
    learner.finish_episode()
    assert learner.penalty_rules[1].sum() == 1
    assert penalty_states(learner, "AB") == "B"
    visit(learner, "AB")
    learner.finish_episode()
    assert penalty_states(learner, "AB") == "AB"


def test_what_led_there_before_it_was_a_penalty_state_is_judged_too():
    learner = new(PARP, (2,), base_weight=OUTWEIGHS_ALL)
    while len(learner.transitions) < 2:
        visit(learner, "AB")
        learner.finish_episode()
    fail(learner, "B", times=2)
    assert penalty_states(learner, "AB") == "AB"


def test_a_reward_on_the_way_hides_no_transition():
    learner = new(PARP, (2,))
    (chosen,) = visit(learner, "A")[0]
    learner.reward(1.0, counts=True)
    learner.advance(at("B"))
    assert learner.transitions == {(0, 0, chosen, 1)}


def test_one_component_without_a_way_out_is_enough():
    learner = new(PARP, (2, 9))
    fail(learner, "A", times=2)
    assert penalty_states(learner, "A") == "A"


def test_where_there_are_penalty_rules_only_all_are_chosen_from():
    learner = new(PARP, (3,), base_weight=OUTWEIGHS_ALL)
    fail(learner, "A", times=3)
    assert {visit(learner, "A")[0] for _ in range(60)} == {(0,), (1,), (2,)}


def test_the_greedy_choice_is_the_best_rule_that_is_no_penalty_rule():
    learner = new(PARP, (3,))
    visit(learner, "A")
    learner.q[0, 0] = 5.0, 1.0, 3.0
    learner.failed[0, 0, 0] = True
    learner.finish_episode()
    assert learner.greedy(at("A")).tolist() == [2]


def test_as_many_decisions_are_blamed_as_the_setting_says():
    learner = new(PARP, (2,), blamed_decisions=2)
    fail(learner, "ABC")
    assert learner.failed[:3].any(axis=(1, 2)).tolist() == [False, True, True]


def test_a_reward_is_shared_as_in_profit_sharing():
    learner = new(PARP, (2,), discount=0.5)
    visit(learner, "AB")
    learner.reward(8.0, counts=True)
    assert learner.q[:2].max(axis=(1, 2)).tolist() == [4, 8]


def test_a_forgotten_state_takes_its_marks_and_transitions_along():
    learner = new(PARP, (2,))
    life = learner.states.settings.life_episodes
    fail(learner, "AB")
    for _ in range(life + 1):
        visit(learner, "CD")
        learner.finish_episode()
    assert learner.states.count == 2
    assert not learner.failed.any()
    assert {(k, to) for k, _, _, to in learner.transitions} == {(0, 1)}


def brute_force(failed, led_to, letters, sizes):
    """All penalty rules and states, from a definition that looks at everything."""
    rules, states = set(failed), set()
    for _ in range(len(letters) + 1):
        states = {
            s
            for s in letters
            for i, size in enumerate(sizes)
            if all((s, i, j) in rules for j in range(size))
        }
        rules |= {rule for rule, following in led_to if following in states}
    return rules, states


@given(
    episodes=st.lists(
        st.tuples(st.text("ABCDE", min_size=1, max_size=6), st.booleans()),
        min_size=1,
        max_size=60,
    ),
    seed=st.integers(0, 99),
    sizes=st.sampled_from([(2,), (2, 3)]),
)
@settings(deadline=None, max_examples=80)
def test_penalty_rules_and_states_are_those_of_brute_force(episodes, seed, sizes):
    learner = new(PARP, sizes, np.random.default_rng(seed))
    failed, led_to = set(), set()
    for letters, fails in episodes:
        rules = [
            {(letter, i, j) for i, j in enumerate(chosen)}
            for letter, chosen in zip(letters, visit(learner, letters), strict=True)
        ]
        for place, following in enumerate(letters[1:]):
            if letters[place] != following:
                led_to |= {(rule, following) for rule in rules[place]}
        if fails:
            learner.penalise(0)
            failed |= rules[-1]
        learner.finish_episode()
    known = sorted({letter for letters, _ in episodes for letter in letters})
    rules, states = brute_force(failed, led_to, known, sizes)
    assert penalty_states(learner, known) == "".join(sorted(states))
    index = {learner.states.find(at(s), create=False): s for s in known}
    marked = np.argwhere(learner.penalty_rules[: len(index)]).tolist()
    assert {(index[k], i, j) for k, i, j in marked} == rules
