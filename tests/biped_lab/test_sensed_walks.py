"""Learned walks with ever worse sensors."""

import pytest

from biped_bringup.run_settings import load_settings
from biped_lab.robustness import learn
from biped_lab.sensed_walks import SENSES, cell, walked

SEED = 71
SHORT = ("gait.steps=1", "gait.double_support_s=0.9")
SETTINGS = load_settings("directed", changes=SHORT)


@pytest.fixture(scope="module")
def learned():
    return learn(SETTINGS, SEED)


def test_perfect_sensors_see_the_walk_that_was_learned(learned):
    [(completed, worst_m)] = walked(learned, SETTINGS, SEED, ())
    assert completed
    sensed = walked(learned, SETTINGS, SEED, SENSES["sensors without noise or delay"])
    assert sensed == [(True, pytest.approx(worst_m, abs=1e-3))]


def test_a_walk_that_its_sensors_end_is_not_completed(learned):
    blind = (*SENSES["noise"], "sim.limits.zmp_error_m=0.001")
    [(completed, _)] = walked(learned, SETTINGS, SEED, blind)
    assert not completed


def test_every_walk_has_noise_of_its_own(learned):
    first, second = walked(learned, SETTINGS, SEED, SENSES["noise"], walks=2)
    assert first != second


def test_a_cell_counts_walks_and_those_whose_true_zmp_stayed_within():
    outcomes = [[(True, 0.060), (True, 0.066)], [(False, 0.07), (True, 0.063)]]
    assert cell(outcomes, 0.065) == "3 (2), 63.0, 66.0 mm; 2 1"
    assert cell([[(False, 0.07)]], 0.065) == "0"
