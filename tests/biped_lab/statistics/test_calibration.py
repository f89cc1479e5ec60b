"""Intervals hold the truth, and tests err, as often as they say; few studies each.

Bands are three standard errors of a share of so many studies. docs/statistics.md has
the figures of many more.
"""

import sys

import numpy as np
import pytest

from biped_lab.statistics import calibration
from biped_lab.statistics.power import Scenario

COVERED = 200
TESTED = 1000


def rng():
    return np.random.default_rng(1)


def band(share, studies):
    margin = 3 * (share * (1 - share) / studies) ** 0.5
    return share - margin, share + margin


@pytest.mark.parametrize("seeds", [15, 30])
@pytest.mark.thorough
def test_intervals_hold_the_truth_in_95_percent_of_studies(seeds):
    found = calibration.coverage(Scenario(1.5, 0.4, 0.1), seeds, COVERED, rng())
    least, most = band(0.95, COVERED)
    assert {
        name for name, share in found.items() if not least <= share <= most
    } == set()


def test_tests_of_equal_arms_find_a_difference_in_5_percent_of_studies():
    found = calibration.rejections(Scenario(1.0, 0.3, 0.1), 15, TESTED, rng())
    least, most = band(0.05, TESTED)
    used = ("Wilcoxon", "in pairs", "log-rank", "RMST")
    assert {name for name in used if not least <= found[name] <= most} == set()


def test_the_test_that_judges_finds_more_among_stuck_runs_than_the_others():
    found = calibration.rejections(Scenario(1.4, 0.2, 0.1), 15, 200, rng())
    assert found["Wilcoxon"] > found["log-rank"] + 0.1 > found["RMST"] + 0.1


def test_the_command_prints_the_tables(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["calibration", "--studies", "1"])
    assert calibration.main() == 0
    lines = capsys.readouterr().out.splitlines()
    cases = (calibration.COVERED, *2 * (calibration.ALIKE,), calibration.DIFFERENT)
    rows_and_heads = sum(len(each) + 2 for each in cases)
    assert sum(line.startswith("|") for line in lines) == rows_and_heads
