"""Times to success of which some are only known to be longer than what was watched.

Kaplan, Meier: Nonparametric estimation from incomplete observations, J. Am. Stat.
Assoc. 53 (1958); the median's interval: Brookmeyer, Crowley, Biometrics 38 (1982).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
from lifelines import KaplanMeierFitter
from lifelines.utils import median_survival_times
from numpy.typing import NDArray
from scipy.stats import binomtest

from biped_common.errors import BipedError

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]

CONFIDENCE = 0.95
"""Level of all intervals."""
ROUNDING = 1e-9
"""Differences below this one are the arithmetic's, not the data's."""


class StatisticsError(BipedError, ValueError):
    """Runs that these statistics do not apply to; the message says which and why."""


class Estimate(NamedTuple):
    """A figure and its 95 % interval.

    An end that the data leave open is infinite (or 0, for what cannot be negative);
    a figure or an interval that they do not give at all is NaN.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class CensoredTimes:
    """What became of the runs of one arm.

    Raises:
        StatisticsError: no runs, a time that is no positive number, or other shapes.
    """

    time: Floats
    """(n,) episodes to success or, where there was none, to the last one watched."""
    reached: Bools
    """(n,) whether there was success."""

    def __post_init__(self) -> None:
        if self.time.shape != self.reached.shape or self.time.ndim != 1:
            raise StatisticsError(
                f"times {self.time.shape} and successes {self.reached.shape}: must be "
                "two rows of the same length"
            )
        if not len(self.time):
            raise StatisticsError("no runs: there is nothing to estimate from")
        wrong = self.time[~(np.isfinite(self.time) & (self.time > 0))]
        if len(wrong):
            raise StatisticsError(f"time to success {wrong[0]:g}: must be positive")

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self.time)


def reached_curve(times: CensoredTimes) -> pd.DataFrame:
    """Return the fraction of runs that have succeeded by each episode (Kaplan-Meier).

    Returns:
        Columns `episode` (0, then each time at which a run ended), `reached`, `low`,
        `high`: a step function, and its pointwise interval (log-log transformed; where
        none or all have succeeded, it would have no width, and is Wilson's).
    """
    fit = KaplanMeierFitter(alpha=1 - CONFIDENCE).fit(times.time, times.reached)
    not_yet = fit.confidence_interval_survival_function_
    share = 1 - fit.survival_function_.iloc[:, 0].to_numpy()
    none, every = share < ROUNDING, share > 1 - ROUNDING
    n = len(times)
    return pd.DataFrame(
        {
            "episode": fit.survival_function_.index.to_numpy(),
            "reached": share,
            "low": np.where(every, proportion(n, n).low, 1 - not_yet.iloc[:, 1]),
            "high": np.where(none, proportion(0, n).high, 1 - not_yet.iloc[:, 0]),
        }
    )


def completed(times: CensoredTimes) -> Estimate:
    """Return the fraction of runs that succeeded at all, with Wilson's interval."""
    return proportion(int(times.reached.sum()), len(times))


def median(times: CensoredTimes) -> Estimate:
    """Return the Kaplan-Meier median; infinite where it is beyond what was watched.

    The interval holds the episodes at which half of the runs may have succeeded, by the
    pointwise interval of the curve.
    """
    _, value = median_range(times, np.ones((1, len(times)), np.int64))
    fit = KaplanMeierFitter(alpha=1 - CONFIDENCE).fit(times.time, times.reached)
    ends = median_survival_times(fit.confidence_interval_survival_function_)
    return Estimate(float(value[0]), *(float(end) for end in ends.iloc[0]))


def median_range(
    times: CensoredTimes, weights: NDArray[np.int64]
) -> tuple[Floats, Floats]:
    """Return what Kaplan-Meier medians are known to lie between, for many samples.

    Where the curve runs level at one half, the median is the middle of that stretch, as
    in R's `survival`: without censoring it is the ordinary sample median. One that is
    beyond the last episode watched is between that and infinity.

    Args:
        times: n runs.
        weights: (samples, n) how often each run is in each sample.

    Returns:
        Two rows (samples,), the same where the median is known.
    """
    # Success comes before censoring in the same episode.
    order = np.lexsort((~times.reached, times.time))
    time, weight = times.time[order], weights[:, order]
    at_risk = weight[:, ::-1].cumsum(axis=1)[:, ::-1]
    succeeded = np.where(times.reached[order], weight, 0)
    not_yet = np.cumprod(1 - succeeded / np.maximum(at_risk, 1), axis=1)
    last = np.where(weight > 0, time, 0.0).max(axis=1)

    def first(there: Bools, otherwise: Floats) -> Floats:
        return np.where(there.any(axis=1), time[there.argmax(axis=1)], otherwise)

    half, less = not_yet <= 0.5 + ROUNDING, not_yet < 0.5 - ROUNDING
    beyond = np.full_like(last, np.inf)
    low = (first(half, last) + first(less, last)) / 2
    high = (first(half, beyond) + first(less, beyond)) / 2
    return low, high


def faster(
    time: Floats, reached: Bools, other_time: Floats, other_reached: Bools
) -> Bools:
    """Return of which pairs of runs it is known that the first is the faster one.

    Args:
        time: (..., n) as in `CensoredTimes`.
        reached: (..., n)
        other_time: (..., m)
        other_reached: (..., m)

    Returns:
        (..., n, m)
    """
    time, other_time = time[..., :, None], other_time[..., None, :]
    tied_but_censored = (time == other_time) & ~other_reached[..., None, :]
    known = reached[..., :, None] & ((time < other_time) | tied_but_censored)
    return np.asarray(known)


def scatter(times: CensoredTimes) -> float:
    """Return the standard deviation of the natural logarithm of the successful times.

    It is what `biped lab power` asks for. A bound that cuts off slow runs makes it
    smaller than it is.
    """
    if times.reached.sum() < 2:
        return float("nan")
    return float(np.log(times.time[times.reached]).std(ddof=1))


def proportion(successes: int, runs: int) -> Estimate:
    """Return successes by runs, with Wilson's interval."""
    test = binomtest(successes, runs)
    interval = test.proportion_ci(CONFIDENCE, method="wilson")
    return Estimate(float(test.statistic), float(interval.low), float(interval.high))
