"""How many times as long as the baseline an arm takes: the ratio of median times.

With a percentile bootstrap interval over seeds: Efron, Tibshirani, An Introduction to
the Bootstrap, Chapman & Hall 1993, Chapter 13.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from biped_lab.statistics.censored import (
    CONFIDENCE,
    CensoredTimes,
    Estimate,
    median_range,
)

SAMPLES = 10_000


def resampled(
    runs: int, rng: np.random.Generator, samples: int = SAMPLES
) -> NDArray[np.int64]:
    """Return how often each run is in each of many draws with replacement.

    Returns:
        (samples + 1, runs); the first row is the sample itself: every run once.
    """
    drawn = rng.multinomial(runs, np.full(runs, 1 / runs), size=samples)
    return np.vstack([np.ones((1, runs), np.int64), drawn])


def ratio_of_medians(
    arm: CensoredTimes,
    baseline: CensoredTimes,
    draws: tuple[NDArray[np.int64], NDArray[np.int64]],
) -> Estimate:
    """Return the arm's median time by the baseline's: below 1, the arm is faster.

    Where a median is beyond what was watched, the ratio is known from one side only:
    there is no value (NaN), and each such sample counts with the lowest ratio that it
    may have for the lower end, with the highest for the upper. The interval is then
    open on that side: infinite where the arm is slow, from 0 on where the baseline is.

    Args:
        arm: its runs.
        baseline: its runs.
        draws: of both; the same for both, where seeds are in pairs.
    """
    low, high = median_range(arm, draws[0])
    low_baseline, high_baseline = median_range(baseline, draws[1])
    lowest, highest = low / high_baseline, high / low_baseline
    tail = (1 - CONFIDENCE) / 2
    # Infinite ratios cannot be interpolated: these methods take ratios as they are.
    return Estimate(
        float(lowest[0]) if lowest[0] == highest[0] else np.nan,
        float(np.quantile(lowest[1:], tail, method="lower")),
        float(np.quantile(highest[1:], 1 - tail, method="higher")),
    )
