"""Figures with percentile bootstrap intervals over seeds.

Efron, Tibshirani: An Introduction to the Bootstrap, Chapman & Hall 1993, Chapter 13.
A sample of the bootstrap is a row of weights: how often each run is in it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from biped_lab.statistics.censored import (
    CONFIDENCE,
    CensoredTimes,
    Estimate,
    Floats,
    median_range,
)

SAMPLES = 10_000

Weights = NDArray[np.int64]


def resampled(
    runs: int, rng: np.random.Generator, samples: int = SAMPLES
) -> Weights:
    """Return the weights (samples + 1, runs) of as many draws with replacement.

    The first row is the sample itself: every run once.
    """
    drawn = rng.multinomial(runs, np.full(runs, 1 / runs), size=samples)
    return np.vstack([np.ones((1, runs), np.int64), drawn])


def expected_running_time(times: CensoredTimes, weights: Weights) -> Estimate:
    """Return the episodes to a success if stuck runs are begun anew at their end.

    ERT = episodes of all runs / number of successes; infinite without success. Hansen
    et al.: COCO, Optimization Methods and Software 36 (2021), Section 4.
    """
    successes = weights @ times.reached.astype(np.int64)
    with np.errstate(divide="ignore"):
        return _percentiles(weights @ times.time / successes)


def ratio_of_medians(
    arm: CensoredTimes, baseline: CensoredTimes, weights: tuple[Weights, Weights]
) -> Estimate:
    """Return the arm's median time by the baseline's: below 1, the arm is faster.

    Where a median is beyond what was watched, the ratio is known from one side only:
    there is no value (NaN), and each such sample counts with the lowest ratio it may
    have for the lower end, with the highest for the upper. The interval is then open
    on that side: infinite above where the arm is slow, 0 below where the baseline is.

    Args:
        arm: its runs.
        baseline: its runs.
        weights: of both; the same rows for both where seeds are paired.
    """
    low, high = median_range(arm, weights[0])
    low_baseline, high_baseline = median_range(baseline, weights[1])
    return _percentiles(low / high_baseline, high / low_baseline)


def _percentiles(low: Floats, high: Floats | None = None) -> Estimate:
    """Return the figure of the first sample, and the interval of all the others.

    Args:
        low: (samples + 1,) figures, or the lowest that they may be.
        high: the highest that they may be.
    """
    high = low if high is None else high
    tail = (1 - CONFIDENCE) / 2
    # Infinite figures cannot be interpolated: these methods take figures as they are.
    return Estimate(
        float(low[0]) if low[0] == high[0] else np.nan,
        float(np.quantile(low[1:], tail, method="lower")),
        float(np.quantile(high[1:], 1 - tail, method="higher")),
    )
