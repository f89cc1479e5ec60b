"""Permutation tests: answers by hand, SciPy's, and what is not to matter."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lifelines.statistics import logrank_test
from scipy import stats
from tests.biped_lab.statistics.test_censored import PLACEBO, TREATED

from biped_lab.statistics.permutation import (
    holm,
    logrank_scores,
    permutation_p,
    relabellings,
    restricted_times,
    swaps,
    wilcoxon_scores,
)

POOLED = (
    np.concatenate([TREATED.time, PLACEBO.time]),
    np.concatenate([TREATED.reached, PLACEBO.reached]),
)
SCORES = (wilcoxon_scores, restricted_times, logrank_scores)
every_score = pytest.mark.parametrize("scores", SCORES)
few = settings(max_examples=20, deadline=None)
studies = st.lists(
    st.tuples(st.integers(1, 30), st.booleans()), min_size=2, max_size=10
).map(lambda drawn: tuple(map(np.array, zip(*drawn, strict=True))))


def rng():
    return np.random.default_rng(0)


# -- scores ------------------------------------------------------------------------


def test_the_wilcoxon_score_is_the_one_that_gehan_gives():
    assert wilcoxon_scores(*POOLED)[: len(TREATED)].sum() == -271


def test_the_logrank_score_is_observed_less_expected():
    # 9 relapses instead of 19.25, in the textbooks' table.
    assert logrank_scores(*POOLED)[:21].sum() == pytest.approx(9 - 19.25, abs=5e-3)


def test_times_are_restricted_to_what_all_runs_were_watched_for():
    time, reached = np.array([3.0, 8.0, 6.0]), np.array([True, True, False])
    assert restricted_times(time, reached).tolist() == [3, 6, 6]


def test_without_censoring_times_are_not_restricted():
    time = np.array([3.0, 8.0])
    assert restricted_times(time, np.array([True, True])).tolist() == [3, 8]


# -- exact tests -------------------------------------------------------------------


def test_three_runs_that_are_all_faster_are_two_of_twenty_labellings():
    labels = relabellings(3, 6, rng())
    assert labels.shape == (6, 20)
    scores = wilcoxon_scores(np.arange(1.0, 7.0), np.ones(6, bool))
    assert permutation_p(scores, labels) == 2 / 20


def test_three_pairs_that_all_say_the_same_are_two_of_eight_swaps():
    assert permutation_p(np.array([1.0, 2.0, 3.0]), swaps(3, rng())) == 2 / 8


def test_a_pair_that_says_the_contrary_counts_by_its_size():
    # Of +-1 +-2 +-3: as far out as 4 are 6, 4 and their opposites.
    assert permutation_p(np.array([-1.0, 2.0, 3.0]), swaps(3, rng())) == 4 / 8


def test_equal_runs_differ_with_p_one():
    scores = wilcoxon_scores(np.full(12, 7.0), np.ones(12, bool))
    assert permutation_p(scores, relabellings(6, 12, rng())) == 1


def test_without_ties_and_censoring_the_test_is_mann_and_whitneys():
    time = rng().permutation(13) + 1.0
    known = stats.mannwhitneyu(time[:6], time[6:], method="exact").pvalue
    scores = wilcoxon_scores(time, np.ones(13, bool))
    assert permutation_p(scores, relabellings(6, 13, rng())) == pytest.approx(known)


def test_scipys_permutation_test_of_means_agrees():
    time = np.array([3.0, 9.0, 5.0, 5.0, 11.0, 12.0, 20.0, 4.0, 15.0, 15.0])
    known = stats.permutation_test(
        (time[:5], time[5:]), lambda a, b, axis: a.mean(axis) - b.mean(axis),
        vectorized=True,
    ).pvalue  # fmt: skip
    assert permutation_p(time, relabellings(5, 10, rng())) == pytest.approx(known)


# -- drawn permutations ------------------------------------------------------------


def test_the_first_labelling_is_the_real_one_and_each_adds_up_to_nothing():
    labels = relabellings(20, 50, rng(), 300)
    assert labels.shape == (50, 300)
    assert (labels[:20, 0] > 0).all()
    assert (labels[20:, 0] < 0).all()
    assert (labels.sum(axis=0) == 0).all()
    assert ((labels > 0).sum(axis=0) == 20).all()


def test_no_p_is_smaller_than_one_of_those_drawn():
    scores = wilcoxon_scores(np.arange(1.0, 61.0), np.ones(60, bool))
    assert permutation_p(scores, relabellings(30, 60, rng(), 500)) == 1 / 500
    assert permutation_p(np.ones(30), swaps(30, rng(), 500)) == 1 / 500


def test_the_permuted_logrank_test_is_near_the_one_of_large_samples():
    time = np.exp(0.6 * rng().standard_normal((2, 60)))
    time[1] *= 1.25
    reached = time < 3
    known = logrank_test(*time, *reached).p_value
    labels = relabellings(60, 120, rng())
    found = permutation_p(logrank_scores(time.ravel(), reached.ravel()), labels)
    assert 0.005 < known < 0.2
    assert found == pytest.approx(known, rel=0.25)


@every_score
@few
@given(studies, st.integers(1, 9), st.sampled_from([2.0, 3.0, 0.5]))
def test_the_unit_of_time_does_not_matter(scores, study, arm_runs, factor):
    time, reached = study[0].astype(float), study[1]
    labels = relabellings(min(arm_runs, len(time) - 1), len(time), rng(), 100)
    assert permutation_p(scores(factor * time, reached), labels) == permutation_p(
        scores(time, reached), labels
    )


@every_score
@few
@given(studies, st.integers(1, 9))
def test_which_arm_is_called_the_first_does_not_matter(scores, study, arm_runs):
    time, reached = study[0].astype(float), study[1]
    arm_runs = min(arm_runs, len(time) - 1)
    labels = relabellings(arm_runs, len(time), rng())
    swapped = relabellings(len(time) - arm_runs, len(time), rng())
    other = np.r_[arm_runs : len(time), :arm_runs]
    assert permutation_p(scores(time, reached), labels) == pytest.approx(
        permutation_p(scores(time[other], reached[other]), swapped)
    )


@few
@given(studies)
def test_a_monotone_change_of_time_leaves_wilcoxons_scores(study):
    time, reached = study
    assert (wilcoxon_scores(time**3.0, reached) == wilcoxon_scores(time, reached)).all()


# -- Holm --------------------------------------------------------------------------


def test_holm_takes_the_smallest_times_their_number_then_one_less():
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])


def test_holm_does_not_count_what_was_not_tested():
    assert holm([0.02, np.nan, 0.6])[[0, 2]] == pytest.approx([0.04, 0.6])
    assert np.isnan(holm([0.02, np.nan])[1])


@few
@given(st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_holm_keeps_the_order_and_lies_between_p_and_bonferroni(p):
    corrected = holm(p)
    assert (corrected >= p).all()
    assert (corrected <= np.minimum(np.array(p) * len(p), 1) + 1e-15).all()
    assert (np.diff(corrected[np.argsort(p)]) >= 0).all()
