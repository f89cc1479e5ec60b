"""A study's arms side by side, and how they differ from its baseline."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from biped_lab.statistics.censored import (
    CensoredTimes,
    Estimate,
    StatisticsError,
    completed,
    median,
    scatter,
)
from biped_lab.statistics.improvement import probability_of_improvement
from biped_lab.statistics.permutation import (
    holm,
    logrank_scores,
    permutation_p,
    relabellings,
    restricted_times,
    swaps,
    wilcoxon_scores,
)
from biped_lab.statistics.resampling import ratio_of_medians, resampled
from biped_lab.statistics.running_time import expected_running_time

FEWEST_RUNS = 5
"""Of fewer, the scatter is not known well enough for intervals: they are NaN."""
NOTHING = Estimate(np.nan, np.nan, np.nan)


def compare(
    runs: pd.DataFrame,
    baseline: str | None,
    most_episodes: int,
    rng: np.random.Generator,
) -> pd.DataFrame:
    """Return one row per arm, in the order in which the arms come.

    An arm's row depends on its own runs and on the baseline's alone (`p_holm` on all),
    since all arms are resampled with the same random numbers; the order of rows in
    `runs` does not matter but for that of the arms.

    Args:
        runs: one row per run: `arm`, `seed`, `state` ("finished", or it has no result
            yet), `reached` (bool), `time` (episodes to success, or watched without).
        baseline: the arm that the others are compared with; None: no comparison.
        most_episodes: the study's bound.
        rng: draws permutations and bootstrap samples.

    Returns:
        Columns; where three are named, they are a figure and its 95 % interval:
            arm, n, unfinished      runs with a result, and without one yet
            completed, _low, _high  fraction that succeeded
            median, _low, _high     episodes, Kaplan-Meier; infinite: beyond the bound
            scatter                 standard deviation of log(time) of the successful
            ert, _low, _high        expected running time with restarts [episodes]
            pairs                   seeds that have runs in both arms
            ratio, _low, _high      median of the arm / median of the baseline
            improvement, _low, _high  probability that the arm is faster
            rmst_difference         restricted mean of the arm - of the baseline
            p_logrank, p_rmst, p_wilcoxon  permutation tests over all runs
            p_paired                Wilcoxon scores, permuted within pairs of a seed
            p_holm                  p_wilcoxon, corrected for the study's comparisons

    Raises:
        StatisticsError: the baseline is no arm, an arm has a seed twice, or a finished
            run has no time.
    """
    arms = list(dict.fromkeys(runs["arm"]))
    if baseline is not None and baseline not in arms:
        raise StatisticsError(
            f"baseline {baseline!r}: no such arm; there are {', '.join(map(str, arms))}"
        )
    finished = runs[runs["state"] == "finished"]
    twice = finished[finished.duplicated(["arm", "seed"])]
    if len(twice):
        raise StatisticsError(
            f"arm {twice['arm'].iloc[0]!r}: seed {twice['seed'].iloc[0]} is there twice"
        )
    untimed = finished[finished["time"].isna()]
    if len(untimed):
        raise StatisticsError(
            f"arm {untimed['arm'].iloc[0]!r}: seed {untimed['seed'].iloc[0]} has "
            "finished without a time"
        )
    by_arm = {
        arm: finished[finished["arm"] == arm].set_index("seed").sort_index()
        for arm in arms
    }
    draws = int(rng.integers(2**63))
    rows: list[dict[str, Any]] = []
    for arm, own in by_arm.items():
        row = {"arm": arm, "n": len(own)}
        row["unfinished"] = int((runs["arm"] == arm).sum()) - len(own)
        row |= _described(own, most_episodes, np.random.default_rng(draws))
        to = own.iloc[:0] if arm == baseline or baseline is None else by_arm[baseline]
        row |= _compared(own, to, np.random.default_rng(draws))
        rows.append(row)
    table = pd.DataFrame(rows)
    table["p_holm"] = holm(table["p_wilcoxon"])
    return table


def _described(
    runs: pd.DataFrame, most_episodes: int, rng: np.random.Generator
) -> dict[str, float]:
    share = middle = ert = NOTHING
    spread = np.nan
    if len(runs):
        times = _times(runs)
        share, middle, spread = completed(times), median(times), scatter(times)
        ert = expected_running_time(times, most_episodes, rng)
        if len(times) < FEWEST_RUNS:
            middle, ert = _value_only(middle), _value_only(ert)
    return (
        _columns("completed", share)
        | _columns("median", middle)
        | {"scatter": spread}
        | _columns("ert", ert)
    )


def _compared(
    runs: pd.DataFrame, baseline: pd.DataFrame, rng: np.random.Generator
) -> dict[str, float]:
    pairs = runs.index.intersection(baseline.index)
    ratio = improvement = NOTHING
    difference = np.nan
    p = dict.fromkeys(("p_logrank", "p_rmst", "p_wilcoxon", "p_paired"), np.nan)
    if len(runs) and len(baseline):
        arm, other = _times(runs), _times(baseline)
        draws = resampled(len(arm), rng)
        # Seeds are drawn in pairs, unless some have no partner.
        paired = runs.index.equals(baseline.index)
        of_both = draws, draws if paired else resampled(len(other), rng)
        ratio = ratio_of_medians(arm, other, of_both)
        improvement = probability_of_improvement(arm, other)
        if min(len(arm), len(other)) < FEWEST_RUNS:
            ratio = _value_only(ratio)

        time = np.concatenate([arm.time, other.time])
        reached = np.concatenate([arm.reached, other.reached])
        labels = relabellings(len(arm), len(time), rng)
        restricted = restricted_times(time, reached)
        difference = restricted[: len(arm)].mean() - restricted[len(arm) :].mean()
        scores = wilcoxon_scores(time, reached)
        p["p_logrank"] = float(permutation_p(logrank_scores(time, reached), labels))
        p["p_rmst"] = float(permutation_p(restricted, labels))
        p["p_wilcoxon"] = float(permutation_p(scores, labels))
        if len(pairs):
            own = scores[: len(arm)][runs.index.get_indexer(pairs)]
            others = scores[len(arm) :][baseline.index.get_indexer(pairs)]
            p["p_paired"] = float(permutation_p(own - others, swaps(len(pairs), rng)))
    return (
        {"pairs": len(pairs)}
        | _columns("ratio", ratio)
        | _columns("improvement", improvement)
        | {"rmst_difference": float(difference)}
        | p
    )


def _times(runs: pd.DataFrame) -> CensoredTimes:
    return CensoredTimes(
        runs["time"].to_numpy(np.float64), runs["reached"].to_numpy(np.bool_)
    )


def _columns(name: str, estimate: Estimate) -> dict[str, float]:
    value, low, high = estimate
    return {name: value, f"{name}_low": low, f"{name}_high": high}


def _value_only(estimate: Estimate) -> Estimate:
    return NOTHING._replace(value=estimate.value)
