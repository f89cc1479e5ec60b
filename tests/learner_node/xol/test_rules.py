"""Action spaces and rule tables, with and without decomposition (Section 3.4)."""

import numpy as np
import pytest

from learner_node.xol.rules import ActionSpace, RuleTable


def test_decomposed_tables_grow_with_the_sum_of_alternatives():
    assert ActionSpace(2, 15).table_shape == (2, 15)


def test_undecomposed_tables_grow_with_their_product():
    assert ActionSpace(2, 15, decomposed=False).table_shape == (1, 225)


def test_a_decomposed_choice_is_the_action():
    chosen = np.array([3, 1, 2])
    assert ActionSpace(3, 4).alternatives_of(chosen).tolist() == [3, 1, 2]


def test_an_action_does_not_change_with_the_next_choice():
    chosen = np.array([3, 1])
    action = ActionSpace(2, 4).alternatives_of(chosen)
    chosen[:] = 0
    assert action.tolist() == [3, 1]


@pytest.mark.parametrize("components, alternatives", [(1, 2), (2, 3), (3, 4)])
def test_undecomposed_choices_stand_for_all_actions_once(components, alternatives):
    space = ActionSpace(components, alternatives, decomposed=False)
    actions = [
        space.alternatives_of(np.array([joint]))
        for joint in range(space.table_shape[1])
    ]
    places = alternatives ** np.arange(components - 1, -1, -1)
    assert [int(action @ places) for action in actions] == list(range(len(actions)))
    assert np.min(actions) == 0
    assert np.max(actions) == alternatives - 1


@pytest.mark.parametrize(
    "components, alternatives, named",
    [(0, 2, "n_components = 0"), (1, 1, "n_alternatives = 1")],
)
def test_a_space_without_a_choice_is_refused(components, alternatives, named):
    with pytest.raises(ValueError, match=named):
        ActionSpace(components, alternatives)


def used_table():
    """A table whose rows are told apart by their number, in every array."""
    table = RuleTable(ActionSpace(2, 3), 4)
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
    unused = getattr(RuleTable(ActionSpace(2, 3), 4), name)
    assert np.array_equal(getattr(table, name)[2:], unused[2:])


@pytest.mark.parametrize("name", RuleTable.ARRAYS)
def test_room_for_more_states_leaves_the_old_ones_as_they_are(name):
    table = used_table()
    before = getattr(table, name).copy()
    table.grow(200)
    assert np.array_equal(getattr(table, name)[: len(before)], before)


def test_new_rows_avoid_every_penalty():
    table = RuleTable(ActionSpace(2, 3), 4)
    table.grow(200)
    assert (table.avoided == 4).all()
    assert len(table.avoided) >= 200
