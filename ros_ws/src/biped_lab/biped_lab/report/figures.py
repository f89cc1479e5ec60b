"""Which figures a study's report has, in which order, and what their captions say."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from biped_lab.report.bars import normalised_and_absolute, one_quantity
from biped_lab.report.curves import (
    RUNNING_MEAN_EPISODES,
    fixed_share,
    fixed_share_by_progress,
    learning_curves,
    share_at_goal,
)
from biped_lab.report.finished import EPISODES, FIXED_SHARE, SIMULATED, FinishedRuns
from biped_lab.report.grid import draw_grid, is_grid
from biped_lab.report.maps import draw_maps, learned_maps
from biped_lab.report.walks import draw_end_causes, draw_replay, never_interrupted
from biped_lab.statistics.comparison import FEWEST_RUNS

_LEADING = {
    "episodes": EPISODES,
    "learning time": SIMULATED,
    "fixed states": FIXED_SHARE,
}
"""Of what the study's own figure is."""


class ReportFigure(NamedTuple):
    """A figure with its caption, or what is said in its place."""

    name: str
    title: str
    caption: str
    figure: Figure | None


def figures(finished: FinishedRuns, rng: np.random.Generator) -> Iterator[ReportFigure]:
    """Yield the figures, the study's own first.

    Args:
        finished: at least one run.
        rng: draws the bootstrap samples of the bars' intervals.
    """
    yield from _quantities(finished, rng)
    if is_grid(finished):
        yield _grid(finished)
    yield _learning_curves(finished)
    yield _share_at_goal(finished)
    if finished.fixing_arms:
        yield _fixed_over_episodes(finished)
        yield _fixed_over_progress(finished)
    yield _end_causes(finished)
    yield _replay(finished)
    yield _maps(finished)


def _quantities(
    finished: FinishedRuns, rng: np.random.Generator
) -> Iterator[ReportFigure]:
    study = finished.results.study
    columns = [EPISODES, SIMULATED, FIXED_SHARE]
    columns.sort(key=lambda column: column != _LEADING[study.figure])
    baseline = study.baseline
    together = baseline in finished.arms and not finished.arrangement.grouped
    for column in columns:
        if column == FIXED_SHARE:
            yield _fixed_states(finished, rng)
        elif not together:
            yield ReportFigure(
                _NAMES[column],
                _TITLES[column],
                _bars_caption(finished),
                one_quantity(finished, column, rng),
            )
        elif column == EPISODES:
            assert baseline is not None
            yield ReportFigure(
                "time_and_episodes",
                "Total learning time and number of episodes",
                f"Above relative to the means of {baseline}, below absolute. "
                + _bars_caption(finished),
                normalised_and_absolute(finished, baseline, rng),
            )


_NAMES = {EPISODES: "episodes", SIMULATED: "learning_time"}
_TITLES = {EPISODES: "Number of episodes", SIMULATED: "Total learning time"}


def _bars_caption(finished: FinishedRuns) -> str:
    runs, bound = finished.runs, finished.bound
    censored = int((~runs["reached"].astype(bool)).sum())
    stopped = (
        f"{censored} of {len(runs)} runs were stopped at the bound of {bound} episodes "
        "without having reached it and count with what they had walked by then: bars "
        f"are means restricted to {bound} episodes, and those with such runs "
        "(hatched) lie below the true means"
        if censored
        else "every run reached it, so that bars are plain means"
    )
    return (
        "Total learning time is the simulated time of all learning episodes until the "
        f"goal; {stopped}. The paper shows means of 15 trials. Dots are runs, dashed "
        f"lines medians. {_interval(finished)}"
    )


def _interval(finished: FinishedRuns) -> str:
    few = [arm for arm in finished.arms if len(finished.of(arm)) < FEWEST_RUNS]
    if len(few) == len(finished.arms):
        return f"No intervals: no arm has {FEWEST_RUNS} runs yet."
    text = "Whiskers: 95 % bootstrap interval over seeds"
    if few:
        text += f"; none where there are fewer than {FEWEST_RUNS} runs"
    return f"{text}."


def _left_out(finished: FinishedRuns) -> str:
    never = [arm for arm in finished.arms if arm not in finished.fixing_arms]
    return f" Left out: {', '.join(never)}, where no state was ever fixed." * bool(
        never
    )


def _fixed_states(finished: FinishedRuns, rng: np.random.Generator) -> ReportFigure:
    title = "Ratio of fixed-mode states to NB"
    if not finished.fixing_arms:
        return ReportFigure(
            "fixed_states", title, "In no run of this study was a state fixed.", None
        )
    caption = (
        "Fixed states over all states NB in memory at the end of a run, whether or not "
        f"it reached the goal. Dots are runs, dashed lines medians, bars means. "
        f"{_interval(finished)}{_left_out(finished)}"
    )
    figure = one_quantity(finished, FIXED_SHARE, rng)
    return ReportFigure("fixed_states", title, caption, figure)


def _compared_in_grey(finished: FinishedRuns) -> str:
    rivals = finished.rivals
    if not rivals:
        return ""
    if len(rivals) == 1:
        return f" Grey: {rivals.pop()}, for comparison."
    return " Grey: the same without fixed mode, for comparison."


def _grid(finished: FinishedRuns) -> ReportFigure:
    frozen = (
        " Right: of the runs at the goal, the share whose frozen walk, tried once, was "
        "completed."
        if finished.tries_frozen_walks
        else ""
    )
    return ReportFigure(
        "grid",
        "The two factors together",
        "Median episodes to the goal (Kaplan and Meier; ∞: beyond what was watched)."
        + frozen,
        draw_grid(finished),
    )


def _learning_curves(finished: FinishedRuns) -> ReportFigure:
    return ReportFigure(
        "learning_curves",
        "Learning curves",
        "Walked time of an episode, for each run the running mean over the last "
        f"{RUNNING_MEAN_EPISODES} episodes: median (line) and quartiles (band) over "
        "the runs. A run that has reached the goal goes on at the longest target "
        "time, one that was stopped at its last value. Dotted: the longest target time."
        + _compared_in_grey(finished),
        learning_curves(finished),
    )


def _share_at_goal(finished: FinishedRuns) -> ReportFigure:
    return ReportFigure(
        "share_at_goal",
        "Runs that have reached the goal",
        "Estimate of Kaplan and Meier with its pointwise 95 % interval (band; Wilson's "
        f"where none or all are there; none of fewer than {FEWEST_RUNS} runs); ticks "
        f"mark runs that were stopped at the bound of {finished.bound} episodes."
        + _compared_in_grey(finished),
        share_at_goal(finished),
    )


def _fixed_over_episodes(finished: FinishedRuns) -> ReportFigure:
    return ReportFigure(
        "fixed_over_episodes",
        "Share of fixed states over the episodes",
        "Median (line) and quartiles (band) over the runs; a run that has ended stays "
        f"at its last value.{_left_out(finished)}",
        fixed_share(finished),
    )


def _fixed_over_progress(finished: FinishedRuns) -> ReportFigure:
    return ReportFigure(
        "fixed_over_progress",
        "Share of fixed states over a run's progress",
        "The same, each run from its first episode (0) to its last (1)."
        + _left_out(finished),
        fixed_share_by_progress(finished),
    )


def _end_causes(finished: FinishedRuns) -> ReportFigure:
    return ReportFigure(
        "end_causes",
        "How episodes ended",
        "Share of each end among all learning episodes of an arm's runs together; "
        "“completed” is the target time of the episode's subtask, not yet the whole "
        "walk.",
        draw_end_causes(finished),
    )


def _replay(finished: FinishedRuns) -> ReportFigure:
    title = "Simulated and computed time"
    left_out = len(finished.runs) - len(never_interrupted(finished))
    if left_out == len(finished.runs):
        return ReportFigure(
            "replay",
            title,
            "All runs were interrupted, and what they computed depends on when.",
            None,
        )
    interrupted = (
        f"{left_out} interrupted runs are left out, since a replay's memory is lost "
        "with an interruption."
        if left_out
        else "No run was interrupted."
    )
    return ReportFigure(
        "replay",
        title,
        "A walk, or its beginning, that was walked before is not computed again but "
        "replayed bit for bit, which greedy actions in fixed states make likely. Each "
        f"mark is a run. {interrupted}",
        draw_replay(finished),
    )


def _maps(finished: FinishedRuns) -> ReportFigure:
    title = "What was learned, over the waist plane"
    maps, missing = learned_maps(finished)
    if not maps:
        why = "Maps need the memories of runs (memory.npz). " + " ".join(missing)
        return ReportFigure("maps", title, why, None)
    caption = (
        "The run in the middle of each arm, by its episodes; states at the centre of "
        "their basis function, the waist relative to the support foot as seen from "
        "above, x ahead and y to the left. Other inputs are not seen, so that states "
        "lie upon each other. Visits: how often a sub-rule of the state was "
        "chosen, each at most once an episode, as the memory counts, which halves old "
        "counts. Corrections: dx and dy of the greedy "
        "action, drawn twice as long as they are."
    )
    left_out = f" Not shown: {' '.join(missing)}" if missing else ""
    return ReportFigure("maps", title, caption + left_out, draw_maps(finished, maps))
