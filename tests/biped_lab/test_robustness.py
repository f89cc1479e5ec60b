"""Learned walks under disturbances."""

import itertools

import pytest

from biped_bringup.run_settings import changed_settings, load_settings
from biped_lab.robustness import (
    DISTURBANCES,
    column,
    completed,
    contestants,
    learn,
    search,
    solve,
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
@pytest.mark.parametrize("while_learning", [False, True])
def test_a_table_has_a_cell_for_each_disturbance(while_learning):
    settings = changed_settings(load_settings("directed"), changes=SHORT)
    cells = list(column(settings, learn, range(SEED, SEED + 1), 2, while_learning))
    assert len(cells) == len(DISTURBANCES)
    assert cells[0].startswith("2 of 2")
    assert all(("learned, " in cell) == while_learning for cell in cells)


def test_what_is_not_learned_in_time_is_none(monkeypatch):
    monkeypatch.setattr("biped_lab.robustness.MOST_EPISODES", 1)
    settings = load_settings("t_ds_080")
    assert learn(settings, SEED) is None and search(settings, SEED) is None


def test_all_walk_the_same_walk():
    every = [settings for _, settings, _ in contestants("t_ds_080")]
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
