"""Who is probably faster: the effect size that belongs to Wilcoxon's test.

Agarwal et al.: Deep reinforcement learning at the edge of the statistical precipice,
NeurIPS 2021, Section 4, call it the probability of improvement.
"""

from __future__ import annotations

from scipy.optimize import brentq
from scipy.stats import norm

from biped_lab.statistics.censored import (
    CONFIDENCE,
    ROUNDING,
    CensoredTimes,
    Estimate,
    faster,
)


def probability_of_improvement(arm: CensoredTimes, other: CensoredTimes) -> Estimate:
    """Return how probably a run of the arm succeeds earlier than one of the other.

    Over all pairs of runs, whatever their seeds; a tie, and a pair of which it is not
    known who is faster, counts one half.

    The interval is not that of a bootstrap, which has no width where one arm wins every
    pair, and held the truth in 52 to 89 % of studies with 5 to 15 seeds and ratio 2
    of times. It is Newcombe's method 5, all values that are at most so many of *their*
    standard errors away: Confidence intervals for an effect size measure based on the
    Mann-Whitney statistic, Part 2, Statistics in Medicine 25 (2006).
    """
    n, m = len(arm), len(other)
    won = int(faster(arm.time, arm.reached, other.time, other.reached).sum())
    lost = int(faster(other.time, other.reached, arm.time, arm.reached).sum())
    share = (n * m + won - lost) / (2 * n * m)
    return Estimate(share, _lower_end(share, n, m), 1 - _lower_end(1 - share, n, m))


def _lower_end(share: float, n: int, m: int) -> float:
    """Return the least probability that the share of n m pairs won is in line with."""
    z = norm.isf((1 - CONFIDENCE) / 2)

    def excess(p: float) -> float:
        correlated = (1 - p) / (2 - p) + p / (1 + p)
        variance = p * (1 - p) * (1 + ((n + m) / 2 - 1) * correlated) / (n * m)
        return float((share - p) ** 2 - z**2 * variance)

    if share == 0:
        return 0.0
    # Positive at 0, negative at the share or, where that is 1, just below it.
    return float(brentq(excess, 0.0, min(share, 1 - ROUNDING)))
