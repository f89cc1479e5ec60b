"""Action selection in normal, fixed and penalty states (Section 3.5)."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from learner_node.xol.selection import choose_greedy, choose_ranked, choose_roulette

N_PENALTIES = 3


def tables(q=None, p=None, avoided=None):
    """Tables (q, p, avoided) of one state with one component, from flat lists.

    `p` is (N_PENALTIES, J), or (J,) for the first type alone.
    """
    alternatives = len(next(x for x in (q, avoided) if x is not None))
    full_p = np.zeros((N_PENALTIES, alternatives))
    if p is not None:
        full_p[: len(np.atleast_2d(p))] = p
    q = np.zeros(alternatives) if q is None else np.array(q, dtype=float)
    if avoided is None:
        avoided = np.full(alternatives, N_PENALTIES)
    return q[None, None], full_p[None, :, None], np.array(avoided)[None, None]


def sizes_of(table):
    return np.array([table.shape[-1]])


def grid(parts, finer=10):
    """Draws that cover [0, 1) evenly, with `parts` * `finer` of them."""
    return (np.arange(parts * finer) + 0.5) / (parts * finer)


def fractions(choose, draws, alternatives):
    """How often each alternative is chosen over these draws, as a fraction."""
    counts = np.zeros(alternatives)
    chosen = np.zeros(1, dtype=np.int64)
    for draw in draws:
        choose(np.array([draw]), chosen)
        counts[chosen[0]] += 1
    return counts / len(draws)


def roulette_shares(q, avoided=None, base=1.0, parts=1):
    q_table, _, avoided_table = tables(q, avoided=avoided)

    def choose(draws, chosen):
        choose_roulette(0, draws, q_table, avoided_table, N_PENALTIES, base, chosen)

    return fractions(choose, grid(parts), len(q))


def ranked_shares(avoided, p=None, parts=1):
    _, p_table, avoided_table = tables(avoided=avoided, p=p)

    def choose(draws, chosen):
        choose_ranked(0, draws, p_table, avoided_table, sizes_of(p_table), chosen)

    return fractions(choose, grid(parts), len(avoided))


def greedy_choice(**lists):
    q_table, p_table, avoided_table = tables(**lists)
    chosen = np.zeros(1, dtype=np.int64)
    choose_greedy(0, q_table, p_table, avoided_table, sizes_of(q_table), chosen)
    return chosen[0]


# -- normal states -------------------------------------------------------------------


def test_all_alternatives_are_equally_likely_while_nothing_is_known():
    assert roulette_shares([0, 0, 0, 0], parts=4).tolist() == [0.25] * 4


def test_the_roulette_is_proportional_to_weight_plus_base():
    expected = np.array([1, 3, 2, 6]) / 12
    np.testing.assert_allclose(roulette_shares([0, 2, 1, 5], parts=12), expected)


def test_a_large_base_weight_hides_the_weights():
    shares = roulette_shares([0, 100], base=1e9, parts=50)
    np.testing.assert_allclose(shares, 0.5, atol=0.01)


def test_penalty_sub_rules_share_their_chance_among_the_others():
    avoided = [N_PENALTIES, 0, N_PENALTIES, N_PENALTIES - 1]
    shares = roulette_shares([0, 50, 2, 50], avoided, parts=4)
    np.testing.assert_allclose(shares, [0.25, 0, 0.75, 0])


weights = st.floats(0.0, 1e6)


@settings(deadline=None, max_examples=100)
@given(
    q_and_avoided=st.lists(
        st.tuples(weights, st.integers(0, N_PENALTIES)), min_size=1, max_size=8
    ),
    base=st.floats(1e-3, 1e3),
    draw=st.floats(0.0, 1.0, exclude_max=True),
)
def test_the_roulette_chooses_no_penalty_sub_rule(q_and_avoided, base, draw):
    q, avoided = zip(*q_and_avoided, (0.0, N_PENALTIES), strict=True)
    q_table, _, avoided_table = tables(q, avoided=avoided)
    chosen = np.full(1, -1)
    choose_roulette(
        0, np.array([draw]), q_table, avoided_table, N_PENALTIES, base, chosen
    )
    assert avoided[chosen[0]] == N_PENALTIES


def test_the_largest_draw_chooses_the_last_candidate():
    q_table, _, avoided_table = tables([0.1, 0.2, 0.3, 0.4], avoided=[3, 3, 3, 0])
    chosen = np.zeros(1, dtype=np.int64)
    largest = np.array([np.nextafter(1.0, 0.0)])
    choose_roulette(0, largest, q_table, avoided_table, N_PENALTIES, 0.1, chosen)
    assert chosen[0] == 2


def test_components_are_chosen_independently():
    q = np.array([[[0.0, 8.0], [8.0, 0.0], [0.0, 0.0]]])
    avoided = np.full(q.shape, N_PENALTIES)
    chosen = np.zeros(3, dtype=np.int64)
    draws = np.array([0.5, 0.5, 0.9])
    choose_roulette(0, draws, q, avoided, N_PENALTIES, 1.0, chosen)
    assert chosen.tolist() == [1, 0, 1]


# -- fixed states ---------------------------------------------------------------------


def test_the_greedy_choice_has_the_largest_weight():
    assert greedy_choice(q=[3, 9, 4]) == 1


def test_the_greedy_choice_is_no_penalty_sub_rule():
    assert greedy_choice(q=[3, 9, 4], avoided=[3, 2, 3]) == 2


def test_among_penalty_sub_rules_the_greedy_choice_avoids_the_gravest_penalties():
    assert greedy_choice(q=[3, 9, 4], avoided=[2, 0, 1]) == 0


def test_of_equal_weights_the_one_with_less_penalty_is_chosen():
    p = [[5, 1, 1, 1], [0, 1, 1, 2], [0, 2, 1, 1]]
    assert greedy_choice(q=[7, 7, 7, 7], p=p) == 2


@pytest.mark.parametrize("alternatives, middle", [(1, 0), (3, 1), (5, 2), (15, 7)])
def test_where_nothing_is_known_the_greedy_choice_is_the_middle(alternatives, middle):
    assert greedy_choice(q=[0] * alternatives) == middle


# -- penalty states -------------------------------------------------------------------


@pytest.mark.parametrize("n", range(1, 7))
def test_rank_r_of_n_is_chosen_with_the_probability_of_the_paper(n):
    expected = [2 * (n - r + 1) / (n * (n + 1)) for r in range(1, n + 1)]
    shares = ranked_shares([1] * n, p=range(n), parts=n * (n + 1) // 2)
    np.testing.assert_allclose(shares, expected)


def test_the_smallest_penalty_summed_over_types_ranks_first():
    p = [[9, 0, 1], [0, 0, 1], [0, 5, 1]]
    np.testing.assert_allclose(
        ranked_shares([1, 1, 1], p, parts=6), np.array([1, 2, 3]) / 6
    )


@pytest.mark.parametrize("n", (3, 40))
def test_equal_penalties_rank_in_the_order_of_the_alternatives(n):
    ranks = n * (n + 1) // 2
    shares = ranked_shares([1] * n, p=[4] * n, parts=ranks)
    np.testing.assert_allclose(shares, np.arange(n, 0, -1) / ranks)


def test_ranking_is_among_those_that_avoid_the_gravest_penalties():
    shares = ranked_shares([0, 2, 1, 2], p=[0, 8, 0, 7], parts=3)
    np.testing.assert_allclose(shares, [0, 1 / 3, 0, 2 / 3])


def test_all_are_equally_likely_where_not_even_the_gravest_can_be_avoided():
    shares = ranked_shares([0, 0, 0, 0], p=[1, 2, 3, 4], parts=4)
    np.testing.assert_allclose(shares, 0.25)
