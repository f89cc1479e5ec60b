"""How many seeds a claim needs, against the theory of the normal distribution."""

import numpy as np
import pytest
from scipy.stats import norm

from biped_common.command_line import CommandParser
from biped_lab.statistics.censored import StatisticsError
from biped_lab.statistics.power import (
    BOUND,
    SEEDS_AT_MOST,
    Scenario,
    seeds_needed,
    wilcoxon_p,
)
from biped_lab.verbs.power import add_parser


def needed(ratio, scatter, stuck=0.0, comparisons=1):
    return seeds_needed(
        Scenario(ratio, scatter, stuck), comparisons, np.random.default_rng(0)
    )


@pytest.mark.thorough
def test_seeds_agree_with_the_theory_of_large_samples():
    z = norm.isf(0.025 / 4) + norm.ppf(0.8)
    # Of a t-test, divided by the efficiency of Wilcoxon's test relative to it.
    known = 2 * (z * 0.3 / np.log(1.3)) ** 2 / 0.955
    assert needed(1.3, 0.3, comparisons=4) == pytest.approx(known, rel=0.12)


@pytest.mark.thorough
def test_the_power_with_other_studies_is_what_was_asked_for():
    scenario = Scenario(1.5, 0.4, 0.1)
    seeds = needed(1.5, 0.4, 0.1)
    studies = scenario.studies(1000, seeds, np.random.default_rng(5))
    power = (wilcoxon_p(*studies, np.random.default_rng(6)) <= 0.05).mean()
    assert 0.75 < power < 0.86  # both shares are of 1,000 studies


@pytest.mark.thorough
def test_scatter_stuck_runs_and_other_comparisons_cost_seeds():
    least = needed(2.0, 0.3)
    assert needed(1.5, 0.3) > least
    assert needed(2.0, 0.4) > least
    assert needed(2.0, 0.3, stuck=0.2) > least
    assert needed(2.0, 0.3, comparisons=5) > least


def test_simulated_runs_are_as_the_scenario_says():
    time, reached = Scenario(1.5, 0.3, 0.2).studies(1, 20_000, np.random.default_rng(0))
    slow, fast = time[0, :, :]
    assert np.median(slow[slow < BOUND]) == pytest.approx(1.5, rel=0.02)
    assert np.log(fast[fast < BOUND]).std() == pytest.approx(0.3, rel=0.02)
    assert reached.mean() == pytest.approx(0.8, abs=0.01)
    assert (time[~reached] == BOUND).all()


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ((0.9, 0.3, 0.1), "ratio 0.9: must be at least 1"),
        ((float("nan"), 0.3, 0.1), "ratio nan"),
        ((1.5, 0.0, 0.1), "scatter 0: must be above 0"),
        ((1.5, 0.3, 1.0), "stuck 1: must be a share below 1"),
    ],
)
def test_a_scenario_that_is_none_is_refused(values, said):
    with pytest.raises(StatisticsError, match=said):
        Scenario(*values)


def test_more_comparisons_than_can_be_simulated_are_refused():
    with pytest.raises(StatisticsError, match="comparisons 51: must be 1 to 50"):
        needed(2.0, 0.3, comparisons=51)


# -- biped lab power ---------------------------------------------------------------


def printed(words, capsys):
    parser = CommandParser(prog="biped lab")
    add_parser(parser.add_subparsers(), words)
    options = parser.parse_args(["power", *words.split()])
    assert options.run(options) == 0
    return capsys.readouterr().out


def test_the_verb_prints_a_table_of_scatters_and_ratios(capsys):
    words = "--ratio 1.5 2 --scatter 0.3 --stuck 0 --comparisons 2"
    table = printed(words, capsys)
    *_, head, line, row = table.splitlines()
    assert head == "| scatter of log(episodes) | ratio 1.5 | ratio 2 |"
    assert line == "|---|---|---|"
    assert row == f"| 0.3 | {needed(1.5, 0.3, 0, 2)} | {needed(2.0, 0.3, 0, 2)} |"
    assert "2 comparisons, 0% stuck" in table


def test_the_verb_says_where_a_claim_is_beyond_reach(capsys):
    table = printed("--ratio 1.05 --scatter 0.5", capsys)
    assert table.endswith(f"| 0.5 | > {SEEDS_AT_MOST} |\n")
