"""How the arms learn: walked time, share of runs at the goal, share of fixed states."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, StrMethodFormatter
from numpy.typing import NDArray

from biped_common.colours import GREY
from biped_common.timing import seconds
from biped_lab.report.finished import FinishedRuns
from biped_lab.report.marks import arm_panels
from biped_lab.statistics.censored import median, reached_curve
from biped_lab.statistics.comparison import FEWEST_RUNS

RUNNING_MEAN_EPISODES = 10
_FAR_FASTER = 20.0
"""So many times as fast as the slowest run, an arm's curve is next to the axis."""
_PROGRESS = np.linspace(0.0, 1.0, 101)

Curves = dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]
"""x (n,) and values (runs, n) by arm."""


def learning_curves(finished: FinishedRuns) -> Figure:
    """Draw the walked time over episodes: median and quartiles over the runs."""
    longest = max(table["target_ticks"].max() for table in finished.tables.values())
    whole_s = seconds(int(longest))
    curves = _over_episodes(finished, finished.arms, _walked_s, at_goal=whole_s)
    figure = _quartile_panels(finished, curves, "walked time [s]", "episode")
    for axes in figure.axes:
        axes.axhline(whole_s, color=GREY, linewidth=0.8, linestyle=":")
        axes.set_ylim(bottom=0.0)
    last = max(len(table) for table in finished.tables.values())
    _episodes_along(figure.axes[0], finished, last)
    return figure


def share_at_goal(finished: FinishedRuns) -> Figure:
    """Draw the share of runs at the goal: Kaplan and Meier, with 95 % intervals."""
    curves = {arm: reached_curve(finished.times(arm)) for arm in finished.arms}
    figure, panels = arm_panels(
        finished, finished.arms, "share of runs at the goal [ ]", "episode"
    )
    for arm, axes in panels:
        rival, colour = finished.arrangement.rivals[arm], finished.arrangement.colours
        if rival in curves:
            _draw_steps(axes, curves[rival], GREY)
        curve = curves[arm]
        times = finished.times(arm)
        if len(times) >= FEWEST_RUNS:
            axes.fill_between(
                curve["episode"], curve["low"], curve["high"], step="post",
                color=colour[arm], alpha=0.2, linewidth=0.0,
            )  # fmt: skip
        _draw_steps(axes, curve, colour[arm])
        censored = times.time[~times.reached]
        shares = [curve["reached"][curve["episode"] <= t].iloc[-1] for t in censored]
        if len(censored):
            axes.plot(
                censored, shares, "|", color=colour[arm], markersize=9.0,
                markeredgewidth=1.4, label="_censored", clip_on=False,
            )  # fmt: skip
    axes.set_ylim(-0.03, 1.03)  # all panels share their axes
    _episodes_along(axes, finished, max(c["episode"].max() for c in curves.values()))
    return figure


def fixed_share(finished: FinishedRuns) -> Figure:
    """Draw the share of fixed states over episodes, of the arms that fix any."""
    curves = _over_episodes(finished, finished.fixing_arms, _fixed_share)
    figure = _quartile_panels(finished, curves, "fixed states / NB [ ]", "episode")
    figure.axes[0].set_ylim(0.0, 1.0)
    return figure


def fixed_share_by_progress(finished: FinishedRuns) -> Figure:
    """Draw the same over the share of its episodes that a run has walked."""
    curves = {
        arm: (
            _PROGRESS,
            np.array(
                [
                    np.interp(_PROGRESS, *_by_progress(t))
                    for t in finished.tables_of(arm)
                ]
            ),
        )
        for arm in finished.fixing_arms
    }
    figure = _quartile_panels(
        finished, curves, "fixed states / NB [ ]", "share of the run's episodes [ ]"
    )
    figure.axes[0].set_ylim(0.0, 1.0)
    figure.axes[0].set_xlim(0.0, 1.0)
    return figure


def _episodes_along(axes: Axes, finished: FinishedRuns, last: float) -> None:
    """Set the axis of the episodes; logarithmic where some arms are far faster."""
    fastest = min(median(finished.times(arm)).value for arm in finished.arms)
    if fastest < last / _FAR_FASTER:
        axes.set_xscale("log")
        axes.set_xlim(1.0, last)
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
    else:
        axes.set_xlim(0.0, last)


def _over_episodes(
    finished: FinishedRuns,
    arms: Sequence[str],
    column: Callable[[pd.DataFrame], NDArray[np.float64]],
    at_goal: float | None = None,
) -> Curves:
    """Return a column of all runs; one that has ended stays at its last value.

    A run at its goal goes on at `at_goal` instead, where that is given.
    """
    longest = max(len(table) for table in finished.tables.values())
    curves = {}
    for arm in arms:
        rows = []
        ends = zip(finished.tables_of(arm), finished.of(arm)["reached"], strict=True)
        for table, at_its_goal in ends:
            values = column(table)
            goes_on = at_goal is not None and at_its_goal
            after = np.full(longest - len(values), at_goal if goes_on else values[-1])
            rows.append(np.concatenate([values, after]))
        curves[arm] = np.arange(1, longest + 1, dtype=np.float64), np.array(rows)
    return curves


def _quartile_panels(
    finished: FinishedRuns, curves: Curves, y_label: str, x_label: str
) -> Figure:
    figure, panels = arm_panels(finished, list(curves), y_label, x_label)
    for arm, axes in panels:
        rival = finished.arrangement.rivals[arm]
        if rival in curves:
            x, values = curves[rival]
            axes.plot(x, np.median(values, axis=0), color=GREY, linewidth=1.1)
        _draw_quartiles(axes, *curves[arm], finished.arrangement.colours[arm])
        axes.set_xlim(left=0.0)
    return figure


def _draw_quartiles(
    axes: Axes, x: NDArray[np.float64], values: NDArray[np.float64], colour: str
) -> None:
    low, middle, high = np.quantile(values, (0.25, 0.5, 0.75), axis=0)
    axes.fill_between(x, low, high, color=colour, alpha=0.2, linewidth=0.0)
    axes.plot(x, middle, color=colour)


def _draw_steps(axes: Axes, curve: pd.DataFrame, colour: str) -> None:
    axes.step(curve["episode"], curve["reached"], where="post", color=colour)


def _walked_s(table: pd.DataFrame) -> NDArray[np.float64]:
    """Return the running mean of the walked time over the last episodes [s]."""
    walked = table["control_ticks"].map(seconds)
    mean = walked.rolling(RUNNING_MEAN_EPISODES, min_periods=1).mean()
    return np.asarray(mean, dtype=np.float64)


def _fixed_share(table: pd.DataFrame) -> NDArray[np.float64]:
    share = table["fixed_states"] / table["basis_states"]
    return np.asarray(share.fillna(0.0), dtype=np.float64)


def _by_progress(
    table: pd.DataFrame,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return np.arange(1, len(table) + 1) / len(table), _fixed_share(table)
