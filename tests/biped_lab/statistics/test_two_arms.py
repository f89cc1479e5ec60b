"""Ratio of medians, probability of improvement: known ratios, open ends, symmetry."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.biped_lab.statistics.test_censored import times

from biped_lab.statistics.censored import CensoredTimes
from biped_lab.statistics.improvement import probability_of_improvement
from biped_lab.statistics.power import Scenario
from biped_lab.statistics.resampling import ratio_of_medians, resampled

SLOW = times(*range(800, 815))
FAST = times(*range(400, 415))
NEVER = times(*["1500+"] * 15)

few = settings(max_examples=20, deadline=None)
arms = st.lists(st.tuples(st.integers(1, 30), st.booleans()), min_size=6, max_size=6)


def censored(drawn):
    time, reached = zip(*drawn, strict=True)
    return CensoredTimes(np.array(time, float), np.array(reached))


def ratio(arm, baseline, samples=2000):
    draws = resampled(len(arm), np.random.default_rng(0), samples)
    return ratio_of_medians(arm, baseline, (draws, draws))


# -- ratio of medians --------------------------------------------------------------


def test_a_known_ratio_is_found_among_many_censored_runs():
    (time,), (reached,) = Scenario(1.7, 0.4, 0.2).studies(
        1, 4000, np.random.default_rng(1)
    )
    found = ratio(
        CensoredTimes(time[0], reached[0]), CensoredTimes(time[1], reached[1])
    )
    assert found.low < 1.7 < found.high
    assert found.value == pytest.approx(1.7, rel=0.08)


def test_an_arm_is_exactly_as_long_as_itself():
    assert ratio(SLOW, SLOW) == (1, 1, 1)


def test_an_arm_that_never_arrives_has_a_ratio_that_is_open_above():
    found = ratio(NEVER, FAST)
    assert np.isnan(found.value)
    assert 1500 / 415 < found.low < 1500 / 399
    assert found.high == np.inf


def test_against_a_baseline_that_never_arrives_the_ratio_is_open_below():
    found = ratio(FAST, NEVER)
    assert np.isnan(found.value)
    assert found.low == 0
    assert 399 / 1500 < found.high < 415 / 1500


def test_of_two_that_never_arrive_nothing_is_known():
    found = ratio(NEVER, NEVER)
    assert np.isnan(found.value)
    assert (found.low, found.high) == (0, np.inf)


def test_a_median_that_is_sometimes_beyond_the_bound_opens_the_interval_only():
    found = ratio(times(*[800] * 9, *["1500+"] * 6), FAST)
    assert found.value == pytest.approx(800 / 407)
    assert found.high == np.inf


def test_drawing_seeds_in_pairs_uses_what_they_have_in_common():
    rng = np.random.default_rng(2)
    time = np.round(400 * np.exp(0.5 * rng.standard_normal(31)))
    arm, baseline = (CensoredTimes(x, np.ones(31, bool)) for x in (2 * time + 1, time))
    draws, others = (resampled(31, np.random.default_rng(i), 500) for i in (3, 4))
    together = ratio_of_medians(arm, baseline, (draws, draws))
    apart = ratio_of_medians(arm, baseline, (draws, others))
    assert together.high - together.low < 0.1 * (apart.high - apart.low)


@few
@given(arms, arms)
def test_swapping_the_arms_inverts_the_ratio(one, other):
    there, back = (
        ratio(censored(a), censored(b), 200) for a, b in ((one, other), (other, one))
    )
    with np.errstate(divide="ignore"):
        assert there.value == pytest.approx(1 / np.float64(back.value), nan_ok=True)
        assert there.low == pytest.approx(1 / np.float64(back.high))
        assert there.high == pytest.approx(1 / np.float64(back.low))


@few
@given(arms, arms, st.sampled_from([0.5, 2.0, 3.0]))
def test_the_unit_of_time_leaves_the_ratio(one, other, factor):
    a, b = censored(one), censored(other)
    scaled = (CensoredTimes(factor * x.time, x.reached) for x in (a, b))
    assert ratio(*scaled, 200) == pytest.approx(ratio(a, b, 200), nan_ok=True)


# -- probability of improvement ----------------------------------------------------


def test_ties_and_pairs_of_censored_runs_count_one_half():
    one, other = times(5, "20+"), times(5, "20+")
    # 5 against 5: half; 5 against 20+: won; 20+ against 5: lost; 20+ with 20+: half.
    assert probability_of_improvement(one, other).value == 0.5
    assert probability_of_improvement(times("7+"), times(9)).value == 0.5


def test_even_an_arm_that_wins_every_pair_is_not_certain_to_win():
    found = probability_of_improvement(FAST, SLOW)
    assert found.value == found.high == 1
    assert 0.8 < found.low < 0.9


@few
@given(arms, arms)
def test_who_is_not_faster_is_slower(one, other):
    there = probability_of_improvement(censored(one), censored(other))
    back = probability_of_improvement(censored(other), censored(one))
    assert there.value == pytest.approx(1 - back.value)
    assert there.low == pytest.approx(1 - back.high)
    assert there.low <= there.value <= there.high
