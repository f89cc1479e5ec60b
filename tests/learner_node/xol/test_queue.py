"""Queue and eligibility traces of online profit sharing (Section 3.2)."""

from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from learner_node.xol.queue import DecisionQueue

SHAPE = (2, 3)


def queue_of(length, *decisions, discount=None):
    """A queue into which (state, chosen) were put, discounted after each."""
    queue = DecisionQueue(length, SHAPE)
    for state, *chosen in decisions:
        queue.push(state, np.array(chosen))
        if discount is not None:
            queue.decay(discount)
    return queue


def test_a_chosen_sub_rule_of_each_component_becomes_eligible():
    queue = queue_of(5, (4, 0, 2))
    assert queue.eligibility[4].tolist() == [[1, 0, 0], [0, 0, 1]]


def test_eligibility_decays_geometrically():
    queue = queue_of(5, (0, 0, 0), (1, 0, 0), (2, 0, 0), discount=0.5)
    assert queue.eligibility[:3, 0, 0].tolist() == [0.125, 0.25, 0.5]


def test_a_sub_rule_chosen_again_adds_to_what_is_left_of_its_trace():
    queue = queue_of(5, (0, 0, 0), (0, 0, 1), discount=0.5)
    assert queue.eligibility[0].tolist() == [[0.75, 0, 0], [0.25, 0.5, 0]]


def test_a_sub_rule_that_leaves_the_queue_is_not_eligible():
    queue = queue_of(2, (0, 0, 0), (1, 0, 0), (2, 0, 0))
    assert queue.eligibility[0].sum() == 0.0


def test_a_sub_rule_chosen_again_stays_when_its_older_place_is_overwritten():
    queue = queue_of(2, (0, 0, 0), (0, 0, 1), (1, 0, 0))
    assert queue.eligibility[0].tolist() == [[2, 0, 0], [0, 1, 0]]


def test_a_cleared_queue_holds_nothing():
    queue = queue_of(3, (0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 0, 0))
    queue.clear()
    assert queue.filled == 0
    assert not queue.eligibility.any()


def test_a_cleared_queue_starts_traces_afresh():
    queue = queue_of(3, (0, 0, 0), (0, 0, 0))
    queue.clear()
    queue.push(0, np.array([0, 0]))
    assert queue.eligibility[0].tolist() == [[1, 0, 0], [1, 0, 0]]


def test_room_for_more_states_leaves_the_traces_as_they_are():
    queue = queue_of(3, (0, 0, 0), (63, 1, 1))
    before = queue.eligibility.copy()
    queue.grow(1000)
    queue.push(999, np.array([2, 2]))
    assert np.array_equal(queue.eligibility[: len(before)], before)


decisions = st.lists(
    st.tuples(st.integers(0, 3), st.integers(0, 2), st.integers(0, 2)), max_size=30
)


@settings(deadline=None, max_examples=100)
@given(length=st.integers(1, 6), decisions=decisions)
def test_a_sub_rule_is_alive_at_one_place_at_most(length, decisions):
    queue = queue_of(length, *decisions)
    alive = Counter(
        (queue.states[place], i, queue.alternatives[place, i])
        for place, i in np.argwhere(queue.live)
    )
    assert set(alive.values()) <= {1}


@settings(deadline=None, max_examples=100)
@given(length=st.integers(1, 6), decisions=decisions)
def test_exactly_the_sub_rules_of_the_last_decisions_are_eligible(length, decisions):
    queue = queue_of(length, *decisions, discount=0.9)
    recent = {(k, i, j) for k, *js in decisions[-length:] for i, j in enumerate(js)}
    eligible = {tuple(each) for each in np.argwhere(queue.eligibility > 0.0).tolist()}
    assert eligible == recent
