"""Directed blame: which alternatives a failure speaks against, and which it clears."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from tests.learner_node.xol.lettered_states import at, index, new_agent, walk

from learner_node.xol import blame
from learner_node.xol.agent import XolAgent

UP, DOWN, NOT = 1.0, -1.0, 0.0


def judged(push, states, alternatives, sizes, share=0.0):
    """{(state, component): alternatives that are no better}."""
    return {
        (k, i): np.flatnonzero(no_better).tolist()
        for k, i, no_better in blame.directed(
            np.array(push),
            np.array(states),
            np.array(alternatives),
            np.array(sizes),
            share,
        )
    }


# -- who is judged -----------------------------------------------------------------


def test_what_pushes_as_hard_or_harder_is_no_better():
    assert judged([[UP]], [4], [[2]], [5]) == {(4, 0): [2, 3, 4]}


def test_where_lower_alternatives_push_it_is_those():
    assert judged([[DOWN]], [4], [[2]], [5]) == {(4, 0): [0, 1, 2]}


def test_what_does_not_push_is_not_judged():
    assert judged([[NOT]], [4], [[2]], [5]) == {}


def test_components_are_judged_apart():
    found = judged([[UP, DOWN]], [0], [[1, 1]], [3, 2])
    assert found == {(0, 0): [1, 2], (0, 1): [0, 1]}


def test_of_a_state_that_chose_twice_the_milder_choice_counts():
    assert judged([[UP], [UP]], [0, 0], [[3], [1]], [5]) == {(0, 0): [1, 2, 3, 4]}


def test_pushes_of_a_state_that_cancel_leave_it_out():
    assert judged([[UP], [DOWN]], [0, 0], [[1], [1]], [3]) == {}


def test_states_that_pushed_too_little_are_left_out():
    found = judged([[1.0], [0.2]], [0, 1], [[1], [1]], [3], share=0.5)
    assert found.keys() == {(0, 0)}


@st.composite
def decisions(draw):
    """Alternatives of the only component; states, choices and pushes by age."""
    n = draw(st.integers(2, 9))
    decision = st.tuples(st.integers(0, 3), st.integers(0, n - 1), st.floats(-1.0, 1.0))
    columns = zip(*draw(st.lists(decision, min_size=1, max_size=12)), strict=True)
    return n, *map(list, columns)


@given(decisions())
def test_the_judged_lie_on_one_side_and_a_chosen_one_at_its_edge(case):
    n, states, chosen, push = case
    found = judged(np.reshape(push, (-1, 1)), states, np.reshape(chosen, (-1, 1)), [n])
    for (k, _), no_better in found.items():
        of_state = [j for s, j in zip(states, chosen, strict=True) if s == k]
        upwards, downwards = (
            list(range(min(of_state), n)),
            list(range(max(of_state) + 1)),
        )
        assert no_better in (upwards, downwards)


# -- what a learner makes of it ------------------------------------------------------


def failed(agent, letters, taken, push):
    walk(agent, letters, taken)
    agent.penalise(0, np.array(push))
    agent.finish_episode()


def forbidden(agent, letter):
    """Penalty sub-rules of the only component."""
    avoided = agent.rules.avoided[index(agent, letter), 0]
    return np.flatnonzero(avoided == 0).tolist()


def test_one_failure_forbids_what_was_never_tried():
    agent = new_agent(n_alternatives=5)
    failed(agent, "A", "2", [[UP]])
    assert forbidden(agent, "A") == [2, 3, 4]


def test_a_failure_on_the_other_side_clears_half_of_the_charge():
    agent = new_agent(n_alternatives=5, minimum_selections=2)
    failed(agent, "A", "3", [[UP]])
    failed(agent, "A", "1", [[DOWN]])
    k = index(agent, "A")
    assert agent.rules.selections[k, 0].tolist() == [2, 2, 2, 2, 2]
    assert agent.rules.failures[k, 0, 0].tolist() == [1, 1, 0, 1, 1]
    assert forbidden(agent, "A") == []  # none failed in more than half of its trials


def test_a_decision_too_old_to_push_is_not_judged():
    agent = new_agent(n_alternatives=3)
    failed(agent, "AB", "11", [[UP]])
    assert (forbidden(agent, "B"), forbidden(agent, "A")) == ([1, 2], [])


def test_old_trials_are_forgotten_in_time():
    agent = new_agent(n_alternatives=3, failure_threshold=1.0, selection_memory=2)
    for _ in range(5):
        failed(agent, "A", "0", [[DOWN]])
    k = index(agent, "A")
    assert agent.rules.selections[k, 0].tolist() == [2, 2, 2]
    assert agent.rules.failures[k, 0, 0].tolist() == [2, 0, 0]


@given(st.integers(1, 13), st.integers(0, 2**32))
def test_failures_on_two_sides_forbid_one_side_at_most(right, seed):
    """A walk fails upwards above `right` and downwards below it."""
    made = new_agent(n_alternatives=15, minimum_selections=1)
    rng = np.random.default_rng(seed)
    agent = XolAgent(made.settings, made.states.settings, made.problem, rng)
    for _ in range(30):
        agent.begin_episode(at("A"))
        (chosen,) = agent.choose().tolist()
        if chosen != right:
            agent.penalise(0, np.array([[UP if chosen > right else DOWN]]))
        agent.finish_episode()
        sides = {np.sign(j - right) for j in forbidden(agent, "A")}
        assert sides <= {1} or sides <= {-1}
