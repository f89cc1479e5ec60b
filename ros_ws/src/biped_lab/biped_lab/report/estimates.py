"""What the figures and tables say of the arms, with 95 % intervals.

Bars are means restricted to the bound, since the paper shows means; their intervals are
percentiles of the bootstrap over seeds, as those of `biped_lab.statistics`.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from biped_lab.report.finished import FinishedRuns
from biped_lab.statistics.censored import CONFIDENCE, Estimate
from biped_lab.statistics.comparison import FEWEST_RUNS, NOTHING, compare
from biped_lab.statistics.permutation import holm
from biped_lab.statistics.resampling import resampled

_TAILS = (0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE)


def restricted_mean(
    finished: FinishedRuns, arm: str, column: str, rng: np.random.Generator
) -> Estimate:
    """Return the mean of an arm's runs, censored ones at their bound."""
    values = finished.values(arm, column)
    if not len(values):
        return NOTHING
    return _estimate(_means(values, resampled(len(values), rng)), len(values))


def ratio_of_means(
    finished: FinishedRuns, arm: str, column: str, rng: np.random.Generator
) -> Estimate:
    """Return an arm's restricted mean over its rival's; NOTHING without a rival."""
    rival = finished.arrangement.rivals[arm]
    if rival is None:
        return NOTHING
    own, other = finished.values(arm, column), finished.values(rival, column)
    if not len(own) or not len(other):
        return NOTHING
    weights = resampled(len(own), rng)
    # Seeds are drawn in pairs, unless some have no partner.
    paired = set(finished.of(arm)["seed"]) == set(finished.of(rival)["seed"])
    of_rival = weights if paired else resampled(len(other), rng)
    means = _means(own, weights) / _means(other, of_rival)
    return _estimate(means, min(len(own), len(other)))


def compared(finished: FinishedRuns, rng: np.random.Generator) -> pd.DataFrame:
    """Return `statistics.compare` of the arms, each with its own rival, by arm.

    P-values are corrected for all comparisons of the study.
    """
    runs, rivals = finished.results.runs, finished.arrangement.rivals
    draws = int(rng.integers(2**63))
    rows = []
    for arm in finished.arms:
        rival = rivals[arm] if rivals[arm] in finished.arms else None
        both = runs[runs["arm"].isin([arm, rival])]
        same = np.random.default_rng(draws)
        table = compare(both, rival, finished.bound, same).set_index("arm")
        rows.append(table.loc[[arm]])
    found = pd.concat(rows)
    found["p_holm"] = holm(found["p_wilcoxon"].to_list())
    return found


def _means(
    values: NDArray[np.float64], weights: NDArray[np.int64]
) -> NDArray[np.float64]:
    return np.asarray(weights @ values / len(values))


def _estimate(samples: NDArray[np.float64], runs: int) -> Estimate:
    """Return the first sample's figure, and the interval of the others."""
    if runs < FEWEST_RUNS:
        return NOTHING._replace(value=float(samples[0]))
    low, high = np.quantile(samples[1:], _TAILS)
    return Estimate(float(samples[0]), float(low), float(high))
