"""Searchers by themselves: they find a hidden corridor, from chance of their own."""

from collections.abc import Callable

import numpy as np
import pytest
from tests.biped_lab.searches.corridor import SPACE, TICKS_PER_POINT, Corridor, search

from biped_lab.searches.cma_es import CmaEs, CmaEsOptions
from biped_lab.searches.genetic import Genetic, GeneticOptions
from biped_lab.searches.searcher import Searcher, Walked
from biped_lab.searches.tail_search import TailSearch, TailSearchOptions

Make = Callable[[np.random.Generator], Searcher]
SEARCHERS: dict[str, Make] = {
    "tail_search": lambda rng: TailSearch(TailSearchOptions(), SPACE, rng),
    "cma_es": lambda rng: CmaEs(CmaEsOptions(), SPACE, rng),
    "genetic": lambda rng: Genetic(GeneticOptions(), SPACE, rng),
}
FAILED_AT_POINT_5 = Walked(6 * TICKS_PER_POINT, False, 1.0)
each_searcher = pytest.mark.parametrize("make", SEARCHERS.values(), ids=SEARCHERS)


@each_searcher
@pytest.mark.parametrize("seed", range(3))
def test_a_hidden_corridor_is_found(make: Make, seed: int) -> None:
    corridor = Corridor(SPACE, seed)
    # Random plans would find it once in 100,000.
    search(make(np.random.default_rng(seed)), corridor, SPACE.points, most=1_500)


def test_an_incremental_horizon_is_followed_to_the_end() -> None:
    corridor, searcher = (
        Corridor(SPACE, 0),
        SEARCHERS["cma_es"](np.random.default_rng(0)),
    )
    for points in range(2, SPACE.points + 1):
        search(searcher, corridor, points, most=500)


@each_searcher
def test_the_same_answers_lead_to_the_same_plans(make: Make) -> None:
    corridor = Corridor(SPACE, 1)
    one, other = (make(np.random.default_rng(7)) for _ in range(2))
    for _ in range(50):
        plan_m = one.ask(SPACE.points)
        assert np.array_equal(plan_m, other.ask(SPACE.points))
        walked = corridor.walk(plan_m, SPACE.points)
        one.tell(walked)
        other.tell(walked)


@each_searcher
def test_nothing_is_drawn_but_from_the_generator_given(make: Make) -> None:
    np.random.seed(5)
    before = np.random.get_state()[1].copy()
    corridor, searcher = Corridor(SPACE, 1), make(np.random.default_rng(7))
    for _ in range(50):
        searcher.tell(corridor.walk(searcher.ask(SPACE.points), SPACE.points))
    assert np.array_equal(before, np.random.get_state()[1])


def test_tail_search_draws_only_the_last_points_up_to_the_failure_anew() -> None:
    searcher = SEARCHERS["tail_search"](np.random.default_rng(0))
    first_m = searcher.ask(SPACE.points).copy()
    searcher.tell(FAILED_AT_POINT_5)
    changed = np.zeros(SPACE.points, dtype=bool)
    for _ in range(30):
        changed |= (searcher.ask(SPACE.points) != first_m).any(axis=1)
    assert np.flatnonzero(changed).tolist() == [3, 4, 5]


def test_tail_search_goes_back_to_the_best_plan() -> None:
    searcher = SEARCHERS["tail_search"](np.random.default_rng(0))
    first_m = searcher.ask(SPACE.points).copy()
    searcher.tell(FAILED_AT_POINT_5)
    searcher.ask(SPACE.points)
    searcher.tell(FAILED_AT_POINT_5._replace(ticks=1))
    assert np.array_equal(searcher.ask(SPACE.points)[:3], first_m[:3])


def test_the_elite_of_a_generation_is_not_lost() -> None:
    options = GeneticOptions(population=4)
    searcher = Genetic(options, SPACE, np.random.default_rng(0))
    best_m = searcher.ask(SPACE.points).copy()
    searcher.tell(FAILED_AT_POINT_5)
    for _ in range(100):
        child_m = searcher.ask(SPACE.points)
        searcher.tell(FAILED_AT_POINT_5._replace(ticks=1))
    # Every child has a parent near: the points behind the reach of any mutation of a
    # walk of one tick stem from the elite, who has won every tournament it was in.
    assert np.array_equal(child_m[6:], best_m[6:])


@pytest.mark.parametrize("cost", [0.0, 5.0, np.inf])
def test_a_tick_more_is_worth_any_cost(cost: float) -> None:
    assert Walked(11, False, cost).loss <= Walked(10, False, 0.0).loss
    assert Walked(11, False, 1.0).loss < Walked(11, False, 2.0).loss
