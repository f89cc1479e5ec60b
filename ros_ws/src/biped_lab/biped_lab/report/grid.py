"""Two factors against each other, a number a cell: how K and LT go together."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from biped_common.colours import INK
from biped_lab.report.finished import FinishedRuns
from biped_lab.report.theme import new_figure
from biped_lab.statistics.censored import median

_FEWEST_SERIES = 3
"""Of two series bars tell more."""
_DARK = 0.6
"""Of the colours' scale; what is written on them is white."""


def is_grid(finished: FinishedRuns) -> bool:
    """Return whether each value of one factor has runs with each of the other."""
    places, series = _sides(finished)
    cells = {(_place(finished, arm), _series(finished, arm)) for arm in finished.arms}
    return len(series) >= _FEWEST_SERIES and len(cells) == len(places) * len(series)


def draw_grid(finished: FinishedRuns) -> Figure:
    """Draw the cells' median episodes, and their frozen walks where they are tried."""
    figure = new_figure(2.9)
    panels = figure.subplots(1, 1 + finished.tries_frozen_walks, squeeze=False)[0]
    _draw(panels[0], finished, "median episodes", _median_episodes, "{:.0f}")
    if finished.tries_frozen_walks:
        name, share = "frozen walk completed", _frozen_share
        _draw(panels[1], finished, name, share, "{:.0%}", (0.0, 1.0))
    return figure


def _draw(
    axes: Axes,
    finished: FinishedRuns,
    title: str,
    value_of: Callable[[FinishedRuns, str], float],
    form: str,
    scale: tuple[float, float] | None = None,
) -> None:
    places, series = _sides(finished)
    values = np.full((len(series), len(places)), np.nan)
    for arm in finished.arms:
        cell = series.index(_series(finished, arm)), places.index(_place(finished, arm))
        values[cell] = value_of(finished, arm)
    known = np.where(np.isfinite(values), values, np.nan)
    seen = values[np.isfinite(values)]
    if scale is None:
        scale = (seen.min(), seen.max()) if len(seen) else (0.0, 1.0)
    low, high = scale
    image = axes.imshow(
        known, cmap="cividis", vmin=low, vmax=high, aspect="auto", origin="lower"
    )
    dark = known < low + _DARK * (high - low)
    for (i, j), value in np.ndenumerate(values):
        text = "∞" if np.isinf(value) else form.format(value)
        text = "–" if np.isnan(value) else text
        colour = "white" if dark[i, j] else INK
        axes.text(j, i, text, ha="center", va="center", color=colour, fontsize=8.0)
    axes.set_xticks(range(len(places)), places)
    axes.set_yticks(range(len(series)), series)
    axes.set_xlabel(finished.arrangement.axis)
    axes.tick_params(length=0)
    axes.set_title(title)
    bar = axes.figure.colorbar(image, ax=axes)
    bar.outline.set_visible(False)
    if form.endswith("%}"):
        bar.ax.yaxis.set_major_formatter(PercentFormatter(1.0))


def _sides(finished: FinishedRuns) -> tuple[Sequence[str], Sequence[str]]:
    """Return the values of either factor, in the study's order."""
    places = dict.fromkeys(_place(finished, arm) for arm in finished.arms)
    series = dict.fromkeys(_series(finished, arm) for arm in finished.arms)
    return list(places), list(series)


def _place(finished: FinishedRuns, arm: str) -> str:
    return finished.arrangement.places[arm]


def _series(finished: FinishedRuns, arm: str) -> str:
    return finished.arrangement.series[arm]


def _median_episodes(finished: FinishedRuns, arm: str) -> float:
    return median(finished.times(arm)).value


def _frozen_share(finished: FinishedRuns, arm: str) -> float:
    walked, runs = finished.frozen_walks(arm)
    return walked / runs if runs else np.nan
