"""Learned walks under disturbances."""

import itertools
from dataclasses import replace

import pytest

from biped_bringup.run_settings import changed_settings, load_settings
from biped_lab.robustness import (
    DISTURBANCES,
    Outcome,
    Trial,
    completed,
    contestants,
    learn,
    search,
    solve,
    tighten,
    within,
)

SHORT = ("gait.steps=1", "gait.double_support_s=0.9")
SEED = 71


@pytest.fixture(scope="module", params=[learn, search, solve])
def learned(request):
    settings = changed_settings(load_settings("t_ds_080"), changes=SHORT)
    return request.param(settings, SEED), settings


def test_what_was_learned_is_walked_undisturbed(learned):
    assert completed(*learned, SEED, walks=2) == 2


def test_a_disturbance_that_nobody_holds_is_felt(learned):
    walk, settings = learned
    hard = ("sim.disturbances.push_force_n=300", "sim.disturbances.push_time_s=1")
    assert completed(walk, changed_settings(settings, changes=hard), SEED) == 0


@pytest.mark.thorough
def test_a_seed_has_an_outcome_for_each_disturbance(monkeypatch):
    learned_with = []

    def solve_and_tell(settings, seed):
        learned_with.append(settings.sim)
        return solve(settings, seed)

    monkeypatch.setattr("biped_lab.robustness.solve", solve_and_tell)
    outcomes = Trial("t_ds_080", "optimum", walks=2).outcomes(SEED)
    assert len(outcomes) == len(DISTURBANCES)
    assert outcomes[0] == Outcome(episodes=0, completed=2)
    assert len(learned_with) == 1

    Trial("t_ds_080", "optimum", while_learning=True).outcomes(SEED)
    plants = learned_with[1:]
    assert len(plants) == len(DISTURBANCES)
    assert all(a != b for a, b in itertools.combinations(plants, 2))


def test_cells_count_walks_of_those_who_learned():
    of_seeds = [
        [Outcome(9, 2), Outcome(9, 1)],
        [Outcome(30, 2), Outcome(30, 2)],
        [Outcome(None, 0), Outcome(None, 0)],
    ]
    at_test = Trial("directed", "beyond", walks=2)
    assert list(at_test.cells(of_seeds)) == ["4 of 4; 2 learned, 30", "3 of 4"]
    throughout = replace(at_test, while_learning=True)
    assert list(throughout.cells(of_seeds))[1] == "3 of 4; 2 learned, 30"
    assert list(at_test.cells(of_seeds[2:])) == ["0 of 0; 0 learned, inf", "0 of 0"]


def test_a_stricter_limit_is_one_of_learning():
    learned_with = []
    settings = load_settings("directed")
    within(0.045, lambda told, _: learned_with.append(told))(settings, SEED)
    (stricter,) = learned_with
    assert stricter.sim.limits.zmp_error_m == 0.045 < settings.sim.limits.zmp_error_m
    assert replace(stricter, sim=settings.sim) == settings


def test_a_learner_goes_on_until_it_has_a_margin(monkeypatch):
    monkeypatch.setattr("biped_lab.robustness.MOST_EPISODES", 40)
    settings = changed_settings(load_settings("t_ds_080"), changes=SHORT)
    first, widest = learn(settings, SEED), tighten(settings, SEED)
    assert first.episodes < widest.episodes <= 40
    stricter = changed_settings(settings, changes=["sim.limits.zmp_error_m=0.0625"])
    assert completed(widest, stricter, SEED) == 1


def test_what_is_not_learned_in_time_is_none(monkeypatch):
    monkeypatch.setattr("biped_lab.robustness.MOST_EPISODES", 1)
    settings = load_settings("t_ds_080")
    assert learn(settings, SEED) is None and search(settings, SEED) is None


def test_all_walk_the_same_walk():
    every = [settings for _, settings, _ in contestants("t_ds_080").values()]
    assert {(each.gait, each.correction) for each in every} == {
        (every[0].gait, every[0].correction)
    }


def test_no_disturbance_is_another_one_or_none():
    undisturbed = load_settings()
    plants = [
        changed_settings(undisturbed, changes=changes).sim
        for changes in DISTURBANCES.values()
    ]
    assert plants[0] == undisturbed.sim
    assert all(a != b for a, b in itertools.combinations(plants, 2))
