"""Penalty sub-rules and penalty states (Sections 2, 3.4 and 3.6, step 2(c)vi)."""

import numpy as np
import pytest
from tests.learner_node.xol.lettered_states import (
    NEVER,
    P_NP,
    at,
    failed_walk,
    failures_of,
    index,
    is_penalty_state,
    make_penalty_state,
    new_agent,
    p_of,
    rewarded_walk,
    selections_of,
    take,
    take_any,
    walk,
)

from learner_node.problem import ActionSpace, Problem

# -- who is a penalty sub-rule --------------------------------------------------------


def avoided(agent, letter):
    """Penalty types that each alternative avoids, from the gravest on."""
    return agent.rules.avoided[index(agent, letter), 0].tolist()


def test_before_n0_selections_no_sub_rule_is_a_penalty_sub_rule():
    agent = new_agent(minimum_selections=3)
    for _ in range(2):
        failed_walk(agent, "A", "0")
    assert avoided(agent, "A") == [3, 3]


def test_at_n0_selections_a_sub_rule_that_fails_is_a_penalty_sub_rule():
    agent = new_agent(minimum_selections=3)
    for _ in range(3):
        failed_walk(agent, "A", "0")
    assert avoided(agent, "A") == [0, 3]


def test_a_failure_rate_of_lambda_is_still_allowed():
    agent = new_agent(minimum_selections=4, failure_threshold=0.5)
    for _ in range(2):
        rewarded_walk(agent, "A", "0")
        failed_walk(agent, "A", "0")
    assert avoided(agent, "A") == [3, 3]


def test_a_failure_rate_above_lambda_makes_a_penalty_sub_rule():
    agent = new_agent(minimum_selections=4, failure_threshold=0.5)
    rewarded_walk(agent, "A", "0")
    for _ in range(3):
        failed_walk(agent, "A", "0")
    assert avoided(agent, "A") == [0, 3]


def test_a_sub_rule_avoids_the_penalties_graver_than_its_own():
    agent = new_agent()
    failed_walk(agent, "A", "0", penalty=1)
    assert avoided(agent, "A") == [1, 3]


def test_failures_of_different_types_do_not_add_up():
    agent = new_agent(minimum_selections=2, failure_threshold=0.5)
    failed_walk(agent, "A", "0", penalty=0)
    failed_walk(agent, "A", "0", penalty=1)
    assert avoided(agent, "A") == [3, 3]


def test_selections_count_once_per_episode():
    agent = new_agent()
    rewarded_walk(agent, "ABAA", "0000")
    assert selections_of(agent, "A") == [1, 0]


def test_selections_count_in_every_episode():
    agent = new_agent()
    for j in "010":
        rewarded_walk(agent, "A", j)
    assert selections_of(agent, "A") == [2, 1]


def test_before_a_sub_rule_is_selected_beyond_its_memory_its_counts_are_halved():
    agent = new_agent(minimum_selections=2, selection_memory=4, failure_threshold=1.0)
    for _ in range(3):
        failed_walk(agent, "A", "0")
    rewarded_walk(agent, "A", "0")
    rewarded_walk(agent, "A", "0")
    assert (selections_of(agent, "A"), failures_of(agent, "A", 0)) == ([3, 0], [1, 0])


def test_without_a_memory_counts_are_never_halved():
    agent = new_agent(minimum_selections=2, selection_memory=0, failure_threshold=1.0)
    for _ in range(40):
        failed_walk(agent, "A", "0")
    assert selections_of(agent, "A") == failures_of(agent, "A", 0) == [40, 0]


def test_what_used_to_succeed_is_judged_by_what_it_leads_to_now():
    agent = new_agent(minimum_selections=2, selection_memory=4, failure_threshold=0.5)
    for _ in range(1000):
        rewarded_walk(agent, "A", "0")
    failures = 0
    while avoided(agent, "A") == [3, 3]:
        failed_walk(agent, "A", "0")
        failures += 1
        assert failures <= 4


def test_failures_count_once_per_episode():
    agent = new_agent(failure_reach=4)
    failed_walk(agent, "AAAA", "0000")
    assert failures_of(agent, "A", 0) == [1, 0]


def test_a_failure_is_credited_to_the_last_decisions():
    agent = new_agent(failure_reach=2, minimum_selections=NEVER)
    failed_walk(agent, "ABC", "010")
    counts = [failures_of(agent, letter, 0) for letter in "ABC"]
    assert counts == [[0, 0], [0, 1], [1, 0]]


# -- eq. (1) --------------------------------------------------------------------------


def test_a_penalty_raises_p_of_the_last_three_decisions_by_their_eligibility():
    agent = new_agent(minimum_selections=NEVER)
    failed_walk(agent, "ABCD", "0101")
    raised = [p_of(agent, letter, 0) for letter in "ABCD"]
    assert raised == [[0, 0], [0, 2.5], [5, 0], [0, 10]]


def test_a_sub_rule_chosen_twice_is_penalised_once():
    agent = new_agent(minimum_selections=NEVER)
    failed_walk(agent, "AA", "00")
    assert p_of(agent, "A", 0) == [10 * (0.5 + 1), 0]


def test_a_penalty_raises_p_of_its_own_type_by_its_own_value():
    agent = new_agent(minimum_selections=NEVER)
    failed_walk(agent, "A", "0", penalty=1)
    assert [p_of(agent, "A", penalty) for penalty in range(3)] == [
        [0, 0],
        [20, 0],
        [0, 0],
    ]


def test_a_penalty_leaves_the_weights_alone():
    agent = new_agent(minimum_selections=NEVER)
    rewarded_walk(agent, "AB", "01")
    before = agent.rules.q.copy()
    failed_walk(agent, "AB", "01")
    assert np.array_equal(agent.rules.q, before)


# -- penalty states -------------------------------------------------------------------


def test_a_state_with_a_way_out_is_no_penalty_state():
    agent = new_agent()
    failed_walk(agent, "A", "0")
    assert not is_penalty_state(agent, "A")


def test_a_state_whose_alternatives_all_fail_is_a_penalty_state():
    agent = new_agent()
    failed_walk(agent, "A", "0")
    failed_walk(agent, "A", "1", penalty=1)
    assert is_penalty_state(agent, "A")


def test_one_component_without_a_way_out_makes_a_penalty_state():
    changes = {"n_components": 2, "n_alternatives": 3, "failure_threshold": 0.4}
    carefree = new_agent(minimum_selections=NEVER, **changes)
    for i in range(3):
        for j in range(3):
            carefree.begin_episode(at("A"))
            take(carefree, i, j)
            # Alternative 0 of the first component always helps; every one of the
            # second component fails two times out of three.
            if i != 0:
                carefree.penalise(0)
            carefree.finish_episode()
    agent = new_agent(minimum_selections=3, **changes)
    agent.restore(carefree.memory())
    walk(agent, "A", [(0, 0)])
    assert is_penalty_state(agent, "A")


def test_a_penalty_state_recovers_when_its_failure_rate_falls():
    agent = new_agent(failure_threshold=0.5)
    make_penalty_state(agent, "A")
    agent.begin_episode(at("A"))
    take_any(agent)
    assert not is_penalty_state(agent, "A")


# -- the additional penalty -----------------------------------------------------------


def test_moving_to_a_penalty_state_pays_the_additional_penalty():
    agent = new_agent()
    make_penalty_state(agent, "B")
    walk(agent, "A", "0")
    agent.advance(at("B"))
    assert p_of(agent, "A", P_NP) == [40, 0]
    assert failures_of(agent, "A", P_NP) == [1, 0]


def test_only_the_decision_that_led_there_pays_the_additional_penalty():
    agent = new_agent()
    make_penalty_state(agent, "C")
    walk(agent, "AB", "00")
    agent.advance(at("C"))
    assert p_of(agent, "A", P_NP) == [0, 0]


def test_staying_in_a_penalty_state_pays_nothing():
    agent = new_agent(failure_threshold=0.4)  # less than 1 failure in 2 selections
    make_penalty_state(agent, "A")
    agent.begin_episode(at("A"))
    take_any(agent)
    agent.advance(at("A"))
    assert is_penalty_state(agent, "A")
    assert p_of(agent, "A", P_NP) == [0, 0]


def test_after_the_additional_penalty_the_episode_goes_on():
    agent = new_agent()
    make_penalty_state(agent, "B")
    walk(agent, "A", "0")
    agent.advance(at("B"))
    take_any(agent)
    agent.advance(at("C"))
    take(agent, 0)
    agent.reward(8.0, counts=False)
    assert agent.rules.q[index(agent, "A"), 0, 0] == 8.0 * 0.25


# -- penalty rule decision (PRD) ------------------------------------------------------


def nearly_penalty_states(letters, **changes):
    """An agent to whom one alternative of each of these states is left, the second."""
    agent = new_agent(**changes)
    for letter in letters:
        failed_walk(agent, letter, "0")
    return agent


def penalty_letters(agent, letters):
    return "".join(letter for letter in letters if is_penalty_state(agent, letter))


def test_a_new_penalty_state_makes_penalty_states_of_those_that_lead_to_it():
    agent = nearly_penalty_states("ABC")
    failed_walk(agent, "ABC", "111")
    assert penalty_letters(agent, "ABC") == "ABC"


def test_each_rule_of_the_chain_pays_the_additional_penalty_by_its_eligibility():
    agent = nearly_penalty_states("ABC")
    failed_walk(agent, "ABC", "111")
    assert [p_of(agent, letter, P_NP)[1] for letter in "ABC"] == [10, 20, 0]


def test_the_chain_ends_at_a_state_with_another_way_out():
    agent = nearly_penalty_states("AC")
    failed_walk(agent, "ABC", "111")
    assert penalty_letters(agent, "ABC") == "C"
    assert p_of(agent, "B", P_NP) == [0, 20]
    assert p_of(agent, "A", P_NP) == [0, 0]


def test_a_new_penalty_state_that_leads_to_itself_is_passed_over():
    agent = nearly_penalty_states("AB")
    failed_walk(agent, "ABB", "111")
    assert p_of(agent, "B", P_NP) == [0, 0]
    assert p_of(agent, "A", P_NP) == [0, 10]


def test_a_penalty_state_already_known_is_not_charged_for_again():
    agent = new_agent(failure_threshold=0.4)  # less than 1 failure in 2 selections
    make_penalty_state(agent, "B")
    walk(agent, "A", "0")
    agent.advance(at("B"))
    take_any(agent)
    paid = p_of(agent, "A", P_NP)
    agent.penalise(0)
    assert p_of(agent, "A", P_NP) == paid


def test_a_state_that_the_failure_is_credited_to_may_start_the_chain():
    agent = nearly_penalty_states("AB", failure_reach=2)
    failed_walk(agent, "ABC", "111")
    assert penalty_letters(agent, "ABC") == "AB"


# -- misuse ---------------------------------------------------------------------------


@pytest.mark.parametrize("penalty", (-1, P_NP, 7))
def test_only_penalties_of_the_environment_can_be_given(penalty):
    agent = new_agent()
    walk(agent, "A", "0")
    with pytest.raises(ValueError, match=f"penalty = {penalty}: .* 0 and 1"):
        agent.penalise(penalty)


def test_a_problem_needs_one_penalty_and_the_additional_one():
    with pytest.raises(ValueError, match="penalty_values"):
        Problem(0, (1.0,), ActionSpace((2,)), (1.0,))
