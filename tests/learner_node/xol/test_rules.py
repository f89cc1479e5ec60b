"""Action spaces and rule tables, with and without decomposition (Section 3.4)."""

import itertools

import numpy as np
import pytest

from learner_node.problem import ActionSpace
from learner_node.xol.rules import RuleTable


def test_decomposed_tables_grow_with_the_sum_of_alternatives():
    assert ActionSpace((15, 15)).table_shape == (2, 15)


def test_undecomposed_tables_grow_with_their_product():
    assert ActionSpace((15, 15), decomposed=False).table_shape == (1, 225)


def test_a_decomposed_choice_is_the_action():
    chosen = np.array([3, 1, 2])
    assert ActionSpace((4, 4, 4)).alternatives_of(chosen).tolist() == [3, 1, 2]


def test_an_action_does_not_change_with_the_next_choice():
    chosen = np.array([3, 1])
    action = ActionSpace((4, 4)).alternatives_of(chosen)
    chosen[:] = 0
    assert action.tolist() == [3, 1]


@pytest.mark.parametrize("alternatives", [(2,), (3, 3), (4, 4, 4), (2, 5, 3)])
def test_undecomposed_choices_stand_for_all_actions_once(alternatives):
    space = ActionSpace(alternatives, decomposed=False)
    actions = [
        tuple(space.alternatives_of(np.array([joint])).tolist())
        for joint in range(space.table_shape[1])
    ]
    assert actions == list(itertools.product(*map(range, alternatives)))


@pytest.mark.parametrize("alternatives", [(), (1,), (3, 1)])
def test_a_space_without_a_choice_is_refused(alternatives):
    with pytest.raises(ValueError, match="alternatives = "):
        ActionSpace(alternatives)


def test_what_a_smaller_component_lacks_is_no_alternative():
    table = RuleTable(ActionSpace((2, 3)), 4)
    assert table.avoided[0].tolist() == [[4, 4, -1], [4, 4, 4]]


def used_table():
    """A table whose rows are told apart by their number, in every array."""
    table = RuleTable(ActionSpace((3, 3)), 4)
    for name in RuleTable.ARRAYS:
        array = getattr(table, name)
        for row in range(5):
            array[row] = row % 2 if array.dtype == bool else row
    return table


@pytest.mark.parametrize("name", RuleTable.ARRAYS)
def test_states_that_are_kept_keep_what_they_learned(name):
    table = used_table()
    before = getattr(table, name).copy()
    table.keep(np.array([1, 4]))
    assert np.array_equal(getattr(table, name)[:2], before[[1, 4]])


@pytest.mark.parametrize("name", RuleTable.ARRAYS)
def test_rows_of_forgotten_states_are_as_new(name):
    table = used_table()
    table.keep(np.array([1, 4]))
    unused = getattr(RuleTable(ActionSpace((3, 3)), 4), name)
    assert np.array_equal(getattr(table, name)[2:], unused[2:])


@pytest.mark.parametrize("name", RuleTable.ARRAYS)
def test_room_for_more_states_leaves_the_old_ones_as_they_are(name):
    table = used_table()
    before = getattr(table, name).copy()
    table.grow(200)
    assert np.array_equal(getattr(table, name)[: len(before)], before)


def test_new_rows_avoid_every_penalty():
    table = RuleTable(ActionSpace((3, 3)), 4)
    table.grow(200)
    assert (table.avoided == 4).all()
    assert len(table.avoided) >= 200
