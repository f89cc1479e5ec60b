"""Tests of no difference between two arms, by permutation of scores.

Every run has a score, computed from the runs of both arms without regard to which run
is whose; the arms differ if the arm's sum of scores is extreme among those of all ways
to say which runs are the arm's. Such a test keeps its level with any number of runs,
whatever the times are like, if the runs of both arms are censored by the same rule.
Source: Good, Permutation, Parametric, and Bootstrap Tests of Hypotheses, Springer 2005.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from biped_lab.statistics.censored import ROUNDING, Bools, Floats, faster

PERMUTATIONS = 10_000
"""So many are drawn; where no more exist, all are taken, and the test is exact."""
_AT_ONCE = 50
"""Studies whose sums, 4 MB, stay in the processor's cache."""


# -- scores: (..., n) times and successes of both arms to (..., n) scores --------------


def wilcoxon_scores(time: Floats, reached: Bools) -> Floats:
    """Return how many runs each is faster than, less how many are faster than it.

    Gehan: A generalized Wilcoxon test for comparing arbitrarily singly-censored
    samples, Biometrika 52 (1965). Their sum over an arm says what the probability of
    improvement says, and without censoring the test is that of Wilcoxon, Mann and
    Whitney.
    """
    known = faster(time, reached, time, reached)
    return np.asarray(known.sum(axis=-1) - known.sum(axis=-2), np.float64)


def restricted_times(time: Floats, reached: Bools) -> Floats:
    """Return the times, those that are longer cut to what all runs were watched for.

    An arm's mean is its restricted mean survival time. Royston, Parmar: BMC Medical
    Research Methodology 13 (2013) 152.
    """
    watched = np.where(reached, np.inf, time).min(axis=-1, keepdims=True)
    return np.asarray(np.minimum(time, watched))


def logrank_scores(time: Floats, reached: Bools) -> Floats:
    """Return successes (0 or 1) less those to be expected, by Nelson's estimate.

    Their sum over an arm is the log-rank test's observed less expected number. Peto,
    Peto: J. R. Stat. Soc. A 135 (1972).
    """
    # For each run (rows): which runs (columns) ended by then.
    ended = time[..., None, :] <= time[..., :, None]
    at_risk = ended.sum(axis=-2)
    hazard = reached / at_risk
    return np.asarray(reached - (ended * hazard[..., None, :]).sum(axis=-1))


# -- tests -----------------------------------------------------------------------------


def relabellings(
    arm_runs: int, runs: int, rng: np.random.Generator, count: int = PERMUTATIONS
) -> NDArray[np.float64]:
    """Return ways to say which runs are the arm's; the first is how it was.

    Args:
        arm_runs: number of the arm's runs, which are the first ones.
        runs: number of the runs of both arms.
        rng: draws them where there are more than `count`.
        count: how many are drawn.

    Returns:
        (runs, at most count) weights whose columns add up to 0, so that equal scores
        have the sum 0.
    """
    if math.comb(runs, arm_runs) <= count:
        chosen = np.array([*itertools.combinations(range(runs), arm_runs)])
    else:
        chosen = rng.permuted(np.tile(np.arange(runs), (count, 1)), axis=1)
        chosen = chosen[:, :arm_runs]
        chosen[0] = np.arange(arm_runs)
    weights = np.full((len(chosen), runs), -float(arm_runs))
    np.put_along_axis(weights, chosen, float(runs - arm_runs), axis=1)
    return weights.T


def swaps(
    pairs: int, rng: np.random.Generator, count: int = PERMUTATIONS
) -> NDArray[np.float64]:
    """Return ways to swap the runs of pairs, as signs of their differences.

    Args:
        pairs: number of pairs of runs, of an arm and of the other one.
        rng: draws them where there are more than `count`.
        count: how many are drawn.

    Returns:
        (pairs, at most count); the first column is how it was: no swap.
    """
    if 2**pairs <= count:
        return np.array([*itertools.product((1.0, -1.0), repeat=pairs)]).T
    signs = rng.choice((1.0, -1.0), size=(pairs, count))
    signs[:, 0] = 1.0
    return signs


def permutation_p(
    scores: Floats, permutations: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return two-sided p-values: how often a sum is as far from 0 as the real one.

    Args:
        scores: (..., n) of runs, or differences of pairs.
        permutations: (n, count) from `relabellings` or `swaps`.
    """
    studies = scores.reshape(-1, len(permutations))
    p = np.empty(len(studies))
    for first in range(0, len(studies), _AT_ONCE):
        block = studies[first : first + _AT_ONCE]
        sums = np.abs(block @ permutations)
        slack = ROUNDING * np.abs(block).sum(axis=1, keepdims=True)
        extreme = sums >= sums[:, :1] - slack
        p[first : first + _AT_ONCE] = extreme.mean(axis=1)
    return p.reshape(scores.shape[:-1])


def holm(p_values: Sequence[float]) -> Floats:
    """Return p-values corrected for their number; NaN, which is no test, stays NaN.

    Holm: A simple sequentially rejective multiple test procedure, Scand. J. Stat. 6
    (1979).
    """
    p = np.asarray(p_values, np.float64)
    order = np.argsort(p)[: np.isfinite(p).sum()]
    corrected = np.full(p.shape, np.nan)
    factors = np.arange(len(order), 0, -1)
    corrected[order] = np.minimum(np.maximum.accumulate(factors * p[order]), 1.0)
    return corrected
