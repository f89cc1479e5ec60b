"""The tables of a study: what its arms achieved, what they cost, and every run."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from scipy.stats import fisher_exact

from biped_lab.markdown import Table
from biped_lab.report.estimates import compared, ratio_of_means, restricted_mean
from biped_lab.report.finished import EPISODES, FIXED_SHARE, SIMULATED, FinishedRuns
from biped_lab.results import ResultsError, StudyResults
from biped_lab.statistics.censored import Estimate, proportion
from biped_lab.statistics.comparison import compare
from biped_lab.statistics.permutation import holm

NOTHING = "–"


def findings_table(finished: FinishedRuns, rng: np.random.Generator) -> Table:
    """Return in short what was found, to be read beside what the paper says."""
    relative = bool(finished.rivals)
    estimate = ratio_of_means if relative else restricted_mean
    form, by = ("{:.2f}", "relative") if relative else ("{:.0f}", "mean")
    draws = int(rng.integers(2**63))
    rows = []
    for arm in finished.arms:
        rng = np.random.default_rng(draws)
        goal = finished.of(arm)["reached"]
        rows.append(
            (
                arm,
                f"{int(goal.sum())} of {len(goal)}",
                _text(estimate(finished, arm, SIMULATED, rng), form),
                _text(estimate(finished, arm, EPISODES, rng), form),
                _text(restricted_mean(finished, arm, FIXED_SHARE, rng), "{:.2f}"),
            )
        )
    head = ("arm", "at the goal", f"time, {by}", f"episodes, {by}", "fixed / NB")
    return Table(head, tuple(rows))


def arms_table(finished: FinishedRuns, rng: np.random.Generator) -> Table:
    """Return what the arms needed, and how they compare with their rivals.

    Nothing in it depends on the machine: the same data give the same bytes.
    """
    statistics = compared(finished, rng)
    draws = int(rng.integers(2**63))
    rows = []
    for arm in finished.arms:
        found, rng = statistics.loc[arm], np.random.default_rng(draws)
        mean_episodes = restricted_mean(finished, arm, EPISODES, rng)
        mean_s = restricted_mean(finished, arm, SIMULATED, rng)
        frozen = [_frozen_walks(finished, arm)] if finished.tries_frozen_walks else []
        share = restricted_mean(finished, arm, FIXED_SHARE, rng)
        rows.append(
            (
                arm,
                str(int(found["n"])),
                str(int(finished.of(arm)["reached"].sum())),
                *frozen,
                _text(_of(found, "median"), "{:.0f}"),
                _text(mean_episodes, "{:.0f}"),
                _text(mean_s, "{:.0f}"),
                _text(_of(found, "ert"), "{:.0f}"),
                _number(found["scatter"], "{:.2f}"),
                finished.arrangement.rivals[arm] or NOTHING,
                _text(_of(found, "ratio"), "{:.2f}"),
                _text(_of(found, "improvement"), "{:.2f}"),
                _number(found["p_holm"], "{:.2g}"),
                _text(share, "{:.2f}"),
            )
        )
    frozen = ["frozen walk"] if finished.tries_frozen_walks else []
    head = (
        "arm", "runs", "at the goal", *frozen,
        "median [episodes]", "mean [episodes]", "mean [s simulated]",
        "with restarts [episodes]", "scatter", "compared with", "ratio of medians",
        "P(faster)", "p (Holm)", "fixed / NB",
    )  # fmt: skip
    return Table(head, tuple(rows))


def comparisons_table(finished: FinishedRuns, rng: np.random.Generator) -> Table:
    """Return all tests of the arms against their rivals, those that judge and others.

    P-values are as they are, without correction for how many there are.
    """
    statistics = compared(finished, rng)
    rows = [
        (
            arm,
            finished.arrangement.rivals[arm] or NOTHING,
            _text(_of(found, "completed"), "{:.2f}"),
            str(int(found["pairs"])),
            _number(found["rmst_difference"], "{:.0f}"),
            *(
                _number(found[p], "{:.2g}")
                for p in ("p_wilcoxon", "p_paired", "p_logrank", "p_rmst")
            ),
            *([_p_frozen(finished, arm)] if finished.tries_frozen_walks else []),
        )
        for arm, found in statistics.iterrows()
    ]
    frozen = ["p, frozen walks"] if finished.tries_frozen_walks else []
    head = (
        "arm", "compared with", "at the goal [ ]", "seeds in both",
        "difference of means [episodes]", "p, Wilcoxon", "p, Wilcoxon within pairs",
        "p, log-rank", "p, mean", *frozen,
    )  # fmt: skip
    return Table(head, tuple(rows))


def _frozen_walks(finished: FinishedRuns, arm: str) -> str:
    """Return how many frozen walks of an arm were completed."""
    walked, runs = finished.frozen_walks(arm)
    if not runs:
        return NOTHING
    share = proportion(walked, runs)
    return f"{walked} of {runs} [{share.low:.2f}, {share.high:.2f}]"


def _p_frozen(finished: FinishedRuns, arm: str) -> str:
    """Return the p-value of Fisher's exact test against the arm's rival."""
    rival = finished.arrangement.rivals[arm]
    if rival is None or rival == arm or rival not in finished.arms:
        return NOTHING
    table = [
        (walked, runs - walked)
        for walked, runs in map(finished.frozen_walks, (arm, rival))
    ]
    return _number(float(fisher_exact(table).pvalue), "{:.2g}")


def studies_table(
    one: StudyResults, other: StudyResults, rng: np.random.Generator
) -> Table:
    """Return how the arms of one study compare with those of the same name in another.

    Where both have the same runs, all is equal. P-values are corrected for all arms.

    Raises:
        ResultsError: no arm of that name, or goals or bounds that differ.
    """
    arms = [arm.name for arm in one.study.arms]
    arms = [name for name in arms if name in {arm.name for arm in other.study.arms}]
    if not arms:
        raise ResultsError(f"{one.study.name}, {other.study.name}: no arm in common")
    if one.study.goal != other.study.goal:
        raise ResultsError(
            f"{one.study.name}, {other.study.name}: the goals {one.study.goal} and "
            f"{other.study.goal} do not compare"
        )
    bound = one.study.most_episodes
    if bound != other.study.most_episodes:
        raise ResultsError(
            f"{one.study.name}, {other.study.name}: bounds of {bound} and "
            f"{other.study.most_episodes} episodes do not compare"
        )
    found = [_both(one.runs, other.runs, arm, bound, rng) for arm in arms]
    corrected = holm([float(both.loc["one", "p_wilcoxon"]) for both in found])
    rows = [
        (
            arm,
            *(
                f"{_text(_of(both.loc[which], 'median'), '{:.0f}')} of "
                f"{int(both.loc[which, 'n'])}"
                for which in ("one", "other")
            ),
            _text(_of(both.loc["one"], "ratio"), "{:.2f}"),
            _text(_of(both.loc["one"], "improvement"), "{:.2f}"),
            _number(float(p), "{:.2g}"),
        )
        for arm, both, p in zip(arms, found, corrected, strict=True)
    ]
    head = (
        "arm", f"{one.study.name}, median [episodes] of runs",
        f"{other.study.name}, the same", "ratio", "P(faster)", "p (Holm)",
    )  # fmt: skip
    return Table(head, tuple(rows))


def _both(
    one: pd.DataFrame,
    other: pd.DataFrame,
    arm: str,
    bound: int,
    rng: np.random.Generator,
) -> pd.DataFrame:
    """Return `compare` of an arm's runs in two studies, as arms `one` and `other`."""
    runs = pd.concat(
        [
            one[one["arm"] == arm].assign(arm="one"),
            other[other["arm"] == arm].assign(arm="other"),
        ]
    )
    return compare(runs, "other", bound, rng).set_index("arm")


def cost_table(finished: FinishedRuns) -> Table:
    """Return what the runs took; it depends on machine and interruptions."""
    rows = []
    for arm in finished.arms:
        runs = finished.of(arm)
        walked = runs["simulated_s"] + runs["evaluation_s"]
        once = runs["sittings"] == 1
        computed = runs["computed_s"][once].sum() / max(walked[once].sum(), 1e-9)
        rows.append(
            (
                arm,
                str(len(runs)),
                str(int((~once).sum())),
                f"{walked.mean():.0f}",
                f"{100 * computed:.0f} %" if once.any() else NOTHING,
                f"{runs['cpu_s'].median():.1f}",
                f"{runs['cpu_s'].sum():.0f}",
            )
        )
    head = (
        "arm", "runs", "interrupted", "walked a run [s simulated]",
        "computed of it", "CPU a run, median [s]", "CPU in all [s]",
    )  # fmt: skip
    return Table(head, tuple(rows))


def runs_table(finished: FinishedRuns) -> Table:
    """Return every run, those without a result too."""
    rows = []
    for run in finished.results.runs.itertuples():
        done = run.state == "finished"
        if not done:
            result = f"unfinished, {run.episodes} episodes so far"
        elif run.reached:
            result = f"goal after {run.time:.0f} episodes"
        else:
            result = f"stopped at {run.time:.0f} episodes"
        rows.append(
            (
                str(run.arm),
                str(run.seed),
                str(run.address),
                result,
                _number(run.simulated_s, "{:.1f}"),
                str(run.trajectory_sha256)[:12] if done else NOTHING,
            )
        )
    head = ("arm", "seed", "address", "result", "simulated [s]", "trajectory")
    return Table(head, tuple(rows))


def _of(row: pd.Series, name: str) -> Estimate:
    return Estimate(*(float(row[name + end]) for end in ("", "_low", "_high")))


def _text(estimate: Estimate, form: str) -> str:
    """Return a figure with its interval, as far as they are there."""
    if math.isnan(estimate.low) or math.isnan(estimate.high):
        return _number(estimate.value, form)
    low, high = _number(estimate.low, form), _number(estimate.high, form)
    return f"{_number(estimate.value, form)} [{low}, {high}]"


def _number(value: float, form: str) -> str:
    if math.isnan(value):
        return NOTHING
    return "∞" if math.isinf(value) else form.format(value)
