"""Discrete states out of mixed inputs (Section 2)."""

import math

import numpy as np
import pytest

from learner_node.problem import ActionSpace, Problem
from learner_node.states import NO_STATE, BasisStates, StateSettings

KINDS = ("gaussian", "uniform")


def basis_states(n_discrete=0, radii=(1.0,), **changes):
    problem = Problem(n_discrete, radii, ActionSpace((2,)), (1.0, 1.0))
    return BasisStates(StateSettings(**changes), problem)


def find(states, *inputs, create=True):
    return states.find(np.array(inputs, dtype=float), create)


def test_the_first_input_becomes_the_centre_of_the_first_state():
    states = basis_states(radii=(2.0, 0.5))
    assert find(states, 3.0, 4.0) == 0
    assert (states.centers[0] * (2.0, 0.5)).tolist() == [3.0, 4.0]


def test_an_input_within_the_width_of_a_state_belongs_to_it():
    states = basis_states(radii=(2.0,))
    find(states, 0.0)
    assert [find(states, x) for x in (1.99, -1.99)] == [0, 0]


def test_an_input_beyond_the_width_of_all_states_makes_a_new_one():
    states = basis_states(radii=(2.0,))
    find(states, 0.0)
    assert find(states, 2.01) == 1


def test_each_input_has_its_own_width():
    states = basis_states(radii=(2.0, 0.5))
    find(states, 0.0, 0.0)
    assert find(states, 1.9, 0.0) == 0
    assert find(states, 0.0, 1.9) == 1


def test_widths_of_several_inputs_add_up_as_an_ellipse():
    states = basis_states(radii=(1.0, 1.0))
    find(states, 0.0, 0.0)
    assert find(states, 0.7, 0.7) == 0
    assert find(states, 0.75, 0.75) == 1


@pytest.mark.parametrize("threshold", (0.1, 0.5, 0.9))
def test_a_state_reaches_as_far_as_it_is_active_above_the_threshold(threshold):
    edge = math.sqrt(-2.0 * math.log(threshold))
    states = basis_states(activation_threshold=threshold)
    find(states, 0.0)
    assert find(states, 0.999 * edge) == 0
    assert find(states, 1.001 * edge) == 1


def test_of_several_active_states_the_most_active_one_is_found():
    states = basis_states()
    find(states, 0.0)
    find(states, 1.5)
    assert [find(states, x) for x in (0.7, 0.8)] == [0, 1]


@pytest.mark.parametrize("basis", KINDS)
def test_discrete_inputs_part_states_of_the_same_continuous_input(basis):
    states = basis_states(n_discrete=2, basis=basis)
    flags = [(10.0, 10.0), (10.0, -10.0), (-10.0, 10.0), (-10.0, -10.0)]
    assert [find(states, *f, 0.0) for f in flags] == [0, 1, 2, 3]
    assert [find(states, *f, 0.0) for f in flags] == [0, 1, 2, 3]


@pytest.mark.parametrize("basis", KINDS)
def test_discrete_inputs_alone_make_states(basis):
    states = basis_states(n_discrete=1, radii=(), basis=basis)
    assert [find(states, x) for x in (1.0, 2.0, 1.0)] == [0, 1, 0]


def test_the_uniform_grid_has_one_state_per_cell():
    states = basis_states(radii=(0.2,), basis="uniform")
    assert [find(states, x) for x in (0.02, 0.09, -0.09, 0.11, 0.29)] == [0, 0, 0, 1, 1]


def test_cells_of_the_uniform_grid_lie_on_multiples_of_the_width():
    states = basis_states(radii=(0.2,), basis="uniform")
    find(states, 0.37)
    assert states.centers[0, 0] * 0.2 == pytest.approx(0.4)


@pytest.mark.parametrize("basis", KINDS)
def test_more_states_than_first_fit_are_all_found_again(basis):
    states = basis_states(n_discrete=1, basis=basis)
    inputs = [(flag, 10.0 * x) for x in range(600) for flag in (-10.0, 10.0)]
    made = [find(states, *each) for each in inputs]
    assert made == list(range(1200))
    assert [find(states, *each) for each in inputs] == made


def test_zero_and_minus_zero_are_the_same_discrete_input():
    states = basis_states(n_discrete=1)
    assert find(states, 0.0, 5.0) == find(states, -0.0, 5.0)


def test_whole_numbers_are_the_same_inputs_as_floating_point_ones():
    states = basis_states(n_discrete=1)
    made = find(states, 1.0, 5.0)
    assert states.find(np.array([1, 5]), create=True) == made


def test_looking_without_making_finds_the_nearest_state_however_far():
    states = basis_states()
    find(states, 0.0)
    find(states, 100.0)
    assert [find(states, x, create=False) for x in (40.0, 60.0)] == [0, 1]


def test_looking_without_making_finds_nothing_in_an_empty_partition():
    states = basis_states(n_discrete=1)
    find(states, 10.0, 0.0)
    assert find(states, -10.0, 0.0, create=False) == NO_STATE


def test_looking_without_making_makes_no_state():
    states = basis_states()
    find(states, 0.0)
    find(states, 50.0, create=False)
    assert states.count == 1


def test_looking_without_making_is_no_visit():
    states = basis_states(life_episodes=2)
    find(states, 0.0)
    for _ in range(3):
        find(states, 0.0, create=False)
        states.age(kept=np.zeros(1, dtype=bool))
    assert states.count == 0


def forgotten_after(states, visit_each_episode=False, kept=False):
    """Episodes until the only state is gone, at most 20."""
    for episode in range(1, 21):
        if visit_each_episode:
            find(states, 0.0)
        states.age(kept=np.full(1, kept))
        if states.count == 0:
            return episode
    return None


@pytest.mark.parametrize("life", (1, 5))
def test_a_state_unvisited_for_its_life_is_forgotten(life):
    states = basis_states(life_episodes=life)
    find(states, 0.0)
    # It is visited in the first episode, and unvisited in `life` more.
    assert forgotten_after(states) == 1 + life


def test_a_visit_gives_a_state_its_whole_life_again():
    states = basis_states(life_episodes=1)
    assert forgotten_after(states, visit_each_episode=True) is None


def test_a_kept_state_is_never_forgotten():
    states = basis_states(life_episodes=1)
    find(states, 0.0)
    assert forgotten_after(states, kept=True) is None


def test_forgetting_tells_which_states_remain_in_order():
    states = basis_states(life_episodes=1)
    for x in (0.0, 10.0, 20.0, 30.0):
        find(states, x)
    nothing_kept = np.zeros(4, dtype=bool)
    assert states.age(nothing_kept) is None
    find(states, 10.0)
    find(states, 30.0)
    assert states.age(nothing_kept).tolist() == [1, 3]
    assert states.centers[: states.count, 0].tolist() == [10.0, 30.0]


def test_a_forgotten_state_is_made_anew():
    states = basis_states(life_episodes=1)
    find(states, 0.0)
    find(states, 10.0)
    forgotten = states.age(np.array([False, True]))
    assert forgotten is None
    states.age(np.array([False, True]))
    assert find(states, 0.0) == 1


@pytest.mark.parametrize("radius", (0.0, -1.0, math.nan, math.inf))
def test_radii_that_are_no_widths_are_refused(radius):
    with pytest.raises(ValueError, match="radii = "):
        basis_states(radii=(1.0, radius))
