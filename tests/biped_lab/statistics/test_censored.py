"""One arm: its curve, median, completed fraction, running time: known answers."""

import statistics

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lifelines import KaplanMeierFitter

from biped_lab.statistics.censored import (
    CensoredTimes,
    StatisticsError,
    completed,
    faster,
    median,
    median_range,
    reached_curve,
    scatter,
)
from biped_lab.statistics.running_time import expected_running_time


def times(*words):
    """Return runs as textbooks write them: 6+ was watched for 6 without success."""
    return CensoredTimes(
        np.array([float(str(word).rstrip("+")) for word in words]),
        np.array([not str(word).endswith("+") for word in words]),
    )


# Remission of leukaemia in weeks: Freireich et al., Blood 21 (1963), the example of
# most textbooks of survival analysis, with the figures that they give.
TREATED = times(
    *(6, 6, 6, "6+", 7, "9+", 10, "10+", "11+", 13, 16, "17+", "19+", "20+", 22, 23),
    *("25+", "32+", "32+", "34+", "35+"),
)
PLACEBO = times(
    *(1, 1, 2, 2, 3, 4, 4, 5, 5, 8, 8, 8, 8, 11, 11, 12, 12, 15, 17, 22, 23)
)

few = settings(max_examples=20, deadline=None)
runs = st.lists(st.tuples(st.integers(1, 30), st.booleans()), min_size=1, max_size=20)


def censored(drawn):
    time, reached = zip(*drawn, strict=True)
    return CensoredTimes(np.array(time, float), np.array(reached))


# -- Kaplan-Meier ------------------------------------------------------------------


def test_the_curve_is_that_of_the_textbooks():
    curve = reached_curve(TREATED).set_index("episode")
    known = {6: 0.857, 7: 0.807, 10: 0.753, 13: 0.690, 16: 0.627, 22: 0.538, 23: 0.448}
    for week, still in known.items():
        assert 1 - curve.loc[week, "reached"] == pytest.approx(still, abs=6e-4)


def test_the_curve_lies_within_its_interval_and_only_rises():
    curve = reached_curve(TREATED)
    assert (curve["low"] <= curve["reached"]).all()
    assert (curve["reached"] <= curve["high"]).all()
    assert curve["reached"].is_monotonic_increasing


@pytest.mark.parametrize(
    ("success", "low", "high"), [(False, 0, 0.49), (True, 0.51, 1)]
)
def test_where_none_or_all_have_succeeded_the_interval_is_wilsons(success, low, high):
    """With four runs: 0.4899, by hand."""
    times = CensoredTimes(np.full(4, 10.0), np.full(4, success))
    last = reached_curve(times).iloc[-1]
    assert (last["low"], last["high"]) == pytest.approx((low, high), abs=0.001)


def test_the_medians_are_those_of_the_textbooks():
    assert median(TREATED).value == 23
    assert median(PLACEBO) == (8, 4, 11)


def test_the_interval_of_a_median_is_open_where_the_curve_leaves_it_open():
    assert median(TREATED).high == np.inf


def test_a_median_beyond_the_bound_is_infinite():
    assert median(times(400, "1500+", "1500+")).value == np.inf
    # Two of four: the median is somewhere between 500 and infinity.
    assert median(times(400, 500, "1500+", "1500+")).value == np.inf


@few
@given(st.lists(st.integers(1, 50), min_size=1, max_size=20))
def test_without_censoring_the_median_is_the_ordinary_one(values):
    assert median(times(*values)).value == statistics.median(values)


@few
@given(runs)
def test_where_the_curve_crosses_one_half_the_median_is_that_of_lifelines(drawn):
    sample = censored(drawn)
    fit = KaplanMeierFitter().fit(sample.time, sample.reached)
    if (abs(fit.survival_function_.iloc[:, 0] - 0.5) > 1e-9).all():
        assert median(sample).value == fit.median_survival_time_


@few
@given(runs, st.randoms(use_true_random=False))
def test_a_run_of_weight_two_counts_as_two_runs(drawn, random):
    weights = [random.randint(0, 3) for _ in drawn]
    repeated = [run for run, weight in zip(drawn, weights, strict=True) for _ in
                range(weight)]  # fmt: skip
    if repeated:
        once = np.ones((1, len(repeated)), int)
        assert median_range(censored(drawn), np.array([weights])) == median_range(
            censored(repeated), once
        )


# -- the other figures of an arm ---------------------------------------------------


def test_the_interval_of_the_completed_fraction_is_wilsons():
    assert completed(times(*["9+"] * 10)) == pytest.approx((0, 0, 0.2775), abs=1e-4)
    assert completed(times(*[9] * 15)) == pytest.approx((1, 0.7961, 1), abs=1e-4)


def test_the_running_time_shares_the_cost_of_stuck_runs_among_the_successes():
    found = expected_running_time(
        times(100, 200, "1500+"), 1500, np.random.default_rng(0)
    )
    assert found.value == 900
    assert found.low < 900 < found.high


def test_without_success_the_running_time_is_only_bounded_below():
    found = expected_running_time(times(*["1500+"] * 5), 1500, np.random.default_rng(0))
    assert found.value == found.high == np.inf
    assert 1500 < found.low < np.inf


def test_five_of_five_do_not_prove_that_no_run_is_ever_stuck():
    found = expected_running_time(times(*[100] * 5), 1500, np.random.default_rng(0))
    assert found.value == 100
    assert found.high > 500


def test_scatter_is_that_of_the_logarithms_of_successes():
    assert scatter(times(10, 1000, "1500+")) == pytest.approx(np.log(100) / 2**0.5)
    assert np.isnan(scatter(times(10, "1500+")))


def test_who_is_faster_is_told_only_where_it_is_known():
    one, other = times(5, "7+", 9), times(5, "5+", 8, "20+")
    assert faster(one.time, one.reached, other.time, other.reached).tolist() == [
        [False, True, True, True],
        [False, False, False, False],
        [False, False, False, True],
    ]


# -- refusals ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("time", "reached", "said"),
    [
        ([], [], "no runs"),
        ([1.0, 2.0], [True], r"\(2,\).*\(1,\)"),
        ([np.nan], [True], "nan: must be positive"),
        ([0.0], [True], "0: must be positive"),
    ],
)
def test_what_is_no_set_of_runs_is_refused(time, reached, said):
    with pytest.raises(StatisticsError, match=said):
        CensoredTimes(np.array(time), np.array(reached, bool))
