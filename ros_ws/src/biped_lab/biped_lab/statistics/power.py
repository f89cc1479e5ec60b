"""How many seeds a claim needs: by simulation, with the very test that judges it.

Times to success are log-normal, as those of the two presets nearly are; a share of the
runs is stuck for good, and all are censored at a bound.
"""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass

import numpy as np

from biped_lab.statistics.censored import Bools, Floats, StatisticsError
from biped_lab.statistics.permutation import (
    permutation_p,
    relabellings,
    wilcoxon_scores,
)

LEVEL = 0.05
POWER = 0.8
BOUND = 4.0
"""Where runs are censored, in medians of the faster arm, as 1,500 episodes to 400."""
SEEDS_AT_MOST = 100
COMPARISONS_AT_MOST = 50
_STUDIES = 1_000


@dataclass(frozen=True)
class Scenario:
    """Two arms as they may be.

    Raises:
        StatisticsError: a ratio below 1, no scatter, or a share outside 0 to 1.
    """

    ratio: float
    """Of median times, slower arm to faster one."""
    scatter: float
    """Standard deviation of the natural logarithm of the time."""
    stuck: float = 0.0
    """Share of runs, in both arms, that never succeed."""

    def __post_init__(self) -> None:
        if not 1 <= self.ratio < np.inf:
            raise StatisticsError(f"ratio {self.ratio:g}: must be at least 1")
        if not 0 < self.scatter < np.inf:
            raise StatisticsError(f"scatter {self.scatter:g}: must be above 0")
        if not 0 <= self.stuck < 1:
            raise StatisticsError(f"stuck {self.stuck:g}: must be a share below 1")

    def studies(
        self, count: int, seeds: int, rng: np.random.Generator
    ) -> tuple[Floats, Bools]:
        """Return times and successes of as many studies, (count, 2, seeds) each.

        The slower arm is the first one; the faster one's median, without stuck runs,
        is 1.
        """
        time = np.exp(self.scatter * rng.standard_normal((count, 2, seeds)))
        time[:, 0] *= self.ratio
        time[rng.random(time.shape) < self.stuck] = np.inf
        return np.minimum(time, BOUND), time <= BOUND


def seeds_needed(
    scenario: Scenario, comparisons: int, rng: np.random.Generator
) -> int | None:
    """Return how many seeds per arm find the difference in 80 % of all studies.

    At the level of 5 % by Wilcoxon's permutation test, as corrected by Holm for a claim
    that stands alone among others: 5 % / comparisons. The power at the answer is known
    to about 2 % (one standard error): of 1,000 studies, judged by the same labellings.

    Args:
        scenario: what is to be found.
        comparisons: of the family.
        rng: draws the studies.

    Returns:
        None where `SEEDS_AT_MOST` are not enough.

    Raises:
        StatisticsError: more comparisons than can be told apart by simulation.
    """
    if not 1 <= comparisons <= COMPARISONS_AT_MOST:
        raise StatisticsError(
            f"comparisons {comparisons}: must be 1 to {COMPARISONS_AT_MOST}"
        )
    time, reached = scenario.studies(_STUDIES, SEEDS_AT_MOST, rng)

    def enough(seeds: int) -> bool:
        both = time[..., :seeds], reached[..., :seeds]
        p = wilcoxon_p(*both, np.random.default_rng(seeds))
        return bool((p <= LEVEL / comparisons).mean() >= POWER)

    # More seeds of the same studies never find much less: the answers are in order.
    # Few seeds take little time: doubling first spares the many.
    most = 4
    while most < SEEDS_AT_MOST and not enough(most):
        most = min(2 * most, SEEDS_AT_MOST)
    seeds = bisect_left(range(2, most + 1), True, key=enough) + 2
    return seeds if seeds <= most else None


def wilcoxon_p(time: Floats, reached: Bools, rng: np.random.Generator) -> Floats:
    """Return the p-value of each study, (count, 2, seeds) to (count,)."""
    seeds = time.shape[-1]
    labels = relabellings(seeds, 2 * seeds, rng)
    scores = [
        wilcoxon_scores(each_time.ravel(), each_reached.ravel())
        for each_time, each_reached in zip(time, reached, strict=True)
    ]
    return permutation_p(np.array(scores), labels)
