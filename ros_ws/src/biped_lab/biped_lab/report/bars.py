"""Figures 2 to 6 of the paper: what the arms need, and how many states they fix."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from biped_common.colours import GREY, ORANGE, SKY
from biped_lab.report.estimates import ratio_of_means, restricted_mean
from biped_lab.report.finished import EPISODES, FIXED_SHARE, SIMULATED, FinishedRuns
from biped_lab.report.marks import (
    bar,
    dots,
    label_places,
    mark_legend,
    median_mark,
    reached,
)
from biped_lab.report.theme import new_figure
from biped_lab.statistics.censored import Estimate

LABELS = {
    EPISODES: "episodes to the goal",
    SIMULATED: "total learning time [s simulated]",
    FIXED_SHARE: "fixed states / NB at the end",
}
_NORMALISED = {
    SIMULATED: ("total learning time", ORANGE),
    EPISODES: ("number of episodes", SKY),
}
_GROUP = 0.8
"""Width of the bars of a place together."""


def normalised_and_absolute(
    finished: FinishedRuns, baseline: str, rng: np.random.Generator
) -> Figure:
    """Draw both quantities as shares of the baseline's means, and as they are."""
    figure = new_figure(5.6)
    panels = figure.subplot_mosaic([["both", "both"], [SIMULATED, EPISODES]])
    _draw_normalised(panels["both"], finished, baseline, rng)
    for column in (SIMULATED, EPISODES):
        _draw_arms(panels[column], finished, column, rng)
    handles = [
        Patch(facecolor=colour, alpha=0.55, label=label)
        for label, colour in _NORMALISED.values()
    ]
    _legend_above(figure, [*handles, *mark_legend(not reached(finished.runs).all())])
    return figure


def one_quantity(
    finished: FinishedRuns, column: str, rng: np.random.Generator
) -> Figure:
    """Draw one quantity, arm by arm."""
    figure = new_figure(3.3)
    axes = figure.subplots()
    _draw_arms(axes, finished, column, rng)
    arrangement = finished.arrangement
    arms = finished.fixing_arms if column == FIXED_SHARE else finished.arms
    series = list(dict.fromkeys(arrangement.series[arm] for arm in arms))
    handles = [
        Patch(
            facecolor=arrangement.colours[arrangement.in_series(name)[0]],
            alpha=0.55,
            label=name,
        )
        for name in series
        if name
    ]
    censored = column != FIXED_SHARE and not reached(finished.runs).all()
    _legend_above(figure, [*handles, *mark_legend(censored)])
    return figure


def _draw_normalised(
    axes: Axes, finished: FinishedRuns, baseline: str, rng: np.random.Generator
) -> None:
    width = _GROUP / len(_NORMALISED)
    for n, (column, (_, colour)) in enumerate(_NORMALISED.items()):
        unit = finished.values(baseline, column).mean()
        for i, arm in enumerate(finished.arms):
            place = i + (n - 0.5) * width
            values = finished.values(arm, column) / unit
            shown = (
                Estimate(1.0, np.nan, np.nan)  # by what the figure shows
                if arm == baseline
                else ratio_of_means(finished, arm, column, rng)
            )
            arrived = reached(finished.of(arm))
            bar(axes, place, width, shown, colour, not arrived.all())
            dots(axes, place, width, values, arrived, colour)
            median_mark(axes, place, width, values)
    axes.axhline(1.0, color=GREY, linewidth=0.8, zorder=0.5)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(f"relative to {baseline} [ ]")
    arrangement = finished.arrangement
    label_places(axes, finished, [arrangement.places[arm] for arm in finished.arms])


def _draw_arms(
    axes: Axes, finished: FinishedRuns, column: str, rng: np.random.Generator
) -> None:
    arrangement = finished.arrangement
    arms = finished.fixing_arms if column == FIXED_SHARE else finished.arms
    places = list(dict.fromkeys(arrangement.places[arm] for arm in arms))
    series = list(dict.fromkeys(arrangement.series[arm] for arm in arms))
    width = _GROUP / len(series)
    for arm in arms:
        beside = series.index(arrangement.series[arm]) - 0.5 * (len(series) - 1)
        place = places.index(arrangement.places[arm]) + beside * width
        runs = finished.of(arm).dropna(subset=[column])
        if runs.empty:
            continue
        values, colour = finished.values(arm, column), arrangement.colours[arm]
        # What is counted at the end is counted in every run.
        known = reached(runs) | (column == FIXED_SHARE)
        mean = restricted_mean(finished, arm, column, rng)
        bar(axes, place, width, mean, colour, not known.all())
        dots(axes, place, width, values, known, colour)
        median_mark(axes, place, width, values)
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(LABELS[column])
    label_places(axes, finished, places)


def _legend_above(figure: Figure, handles: Sequence[Artist]) -> None:
    figure.legend(
        handles=handles,
        loc="outside upper left",
        ncols=len(handles),
        columnspacing=1.2,
        handletextpad=0.5,
    )
