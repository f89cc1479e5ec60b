"""What the figures of arms have in common: bars, dots of runs, panels of arms."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import BarContainer
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from biped_common.colours import GREY, INK, PAPER
from biped_lab.report.arrangement import NO_FIXED_MODE
from biped_lab.report.finished import FinishedRuns
from biped_lab.report.theme import WIDTH_IN, new_figure
from biped_lab.statistics.censored import Estimate

_BESIDE = 0.55
"""Share of a bar's width over which the dots of its runs are spread."""
_BOUNDED = "////"
_MOST_COLUMNS = 4
_PANEL_IN = 1.75
_TITLE_LINE_IN = 0.2


def bar(
    axes: Axes,
    place: float,
    width: float,
    estimate: Estimate,
    colour: str,
    bounded: bool,
) -> BarContainer:
    """Draw a mean with its interval; hatched where runs are cut off at the bound."""
    low, high = estimate.value - estimate.low, estimate.high - estimate.value
    drawn = axes.bar(
        place,
        estimate.value,
        width,
        color=colour,
        alpha=0.55,
        hatch=_BOUNDED if bounded else None,
        edgecolor=PAPER,
        linewidth=0.0,
    )
    if np.isfinite((low, high)).all():
        axes.errorbar(
            place,
            estimate.value,
            yerr=[[max(low, 0.0)], [max(high, 0.0)]],
            color=INK,
            capsize=2.5,
            linewidth=1.0,
        )
    return drawn


def dots(
    axes: Axes,
    place: float,
    width: float,
    values: NDArray[np.float64],
    reached: NDArray[np.bool_],
    colour: str,
) -> None:
    """Draw every run beside the others: filled, or open where it is censored."""
    spread = _BESIDE * width * (_places(len(values)) - 0.5)
    for kept, face in ((reached, colour), (~reached, PAPER)):
        if kept.any():
            axes.plot(
                (place + spread)[kept],
                values[kept],
                "o",
                markersize=3.6,
                markerfacecolor=face,
                markeredgecolor=INK,
                markeredgewidth=0.7,
                label="_run" if face == colour else "_censored",
            )


def median_mark(
    axes: Axes, place: float, width: float, values: NDArray[np.float64]
) -> None:
    """Draw the median of the runs across their bar."""
    half, median = 0.46 * width, float(np.median(values))
    axes.plot(
        [place - half, place + half],
        [median, median],
        color=INK,
        linewidth=1.4,
        dashes=(1.5, 1.0),
        label="_median",
    )


def mark_legend(censored: bool) -> list[Artist]:
    """Return what explains dots and the median's mark."""

    def dot(face: str, label: str) -> Line2D:
        return Line2D(
            [], [], linestyle="", marker="o", markersize=4, markeredgecolor=INK,
            markerfacecolor=face, label=label,
        )  # fmt: skip

    found: list[Artist] = [dot(GREY, "run")]
    if censored:
        found.append(dot(PAPER, "stopped run"))
        found.append(
            Patch(
                facecolor=GREY, alpha=0.55, hatch=_BOUNDED, edgecolor=PAPER,
                linewidth=0.0, label="mean with stopped runs",
            )
        )  # fmt: skip
    median = Line2D([], [], color=INK, linewidth=1.4, dashes=(1.5, 1.0), label="median")
    return [*found, median]


def label_places(axes: Axes, finished: FinishedRuns, places: Sequence[str]) -> None:
    """Name the places along the axis of the arms, aslant where names have no room."""
    upright = [wrapped(place) for place in places]
    longest = max(len(line) for name in upright for line in name.split("\n"))
    room_in = WIDTH_IN * axes.get_position().width / len(places)
    if longest * _LETTER_IN > room_in:
        axes.set_xticks(
            range(len(places)),
            places,
            rotation=40.0,
            ha="right",
            rotation_mode="anchor",
        )
    else:
        axes.set_xticks(range(len(places)), upright)
    axes.tick_params(axis="x", length=0.0)
    label = _AXES.get(finished.arrangement.axis, finished.arrangement.axis)
    without = "; none: no fixed mode" if NO_FIXED_MODE in places else ""
    axes.set_xlabel(label + without)
    # A bar alone is no wider than others are.
    free = max(0.0, 0.5 * (_FEWEST_PLACES - len(places)))
    axes.set_xlim(-0.55 - free, len(places) - 0.45 + free)


_AXES = {"K": "K [rewards]", "LT": "LT [successes per subtask]"}
_FEWEST_PLACES = 4
_LETTER_IN = 0.06
"""Width of a letter of the labels [in], in the mean."""


def arm_panels(
    finished: FinishedRuns, arms: Sequence[str], y_label: str, x_label: str
) -> tuple[Figure, list[tuple[str, Axes]]]:
    """Return a figure with a panel for each arm, and the arms with their panels."""
    columns = min(_MOST_COLUMNS, len(arms))
    if len(arms) > _MOST_COLUMNS:  # rows of about the same length
        columns = math.ceil(len(arms) / math.ceil(len(arms) / _MOST_COLUMNS))
    rows = math.ceil(len(arms) / columns)
    titles = [wrapped(finished.arrangement.title(arm), 20) for arm in arms]
    lines = max((title.count("\n") for title in titles), default=0)
    row_in = _PANEL_IN + _TITLE_LINE_IN * lines
    figure = new_figure(row_in * rows + (0.9 if rows == 1 else 0.4))
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for unused in grid.flat[len(arms) :]:
        unused.set_visible(False)
    for i, (title, axes) in enumerate(zip(titles, grid.flat, strict=False)):
        axes.set_title(title)
        if i + columns >= len(arms):
            axes.tick_params(labelbottom=True)
    figure.supxlabel(x_label, fontsize=9.0)
    figure.supylabel(y_label, fontsize=9.0)
    return figure, list(zip(arms, grid.flat, strict=False))


def reached(runs: pd.DataFrame) -> NDArray[np.bool_]:
    """Return (runs,) whether they reached the goal."""
    return np.asarray(runs["reached"], dtype=np.bool_)


def _places(n: int) -> NDArray[np.float64]:
    """Return (n,) numbers in [0, 1], neighbours far apart: the golden ratio's."""
    return np.asarray((0.5 + 0.6180339887 * np.arange(n)) % 1.0)


def wrapped(text: str, width: int = 12) -> str:
    """Return a text in lines of about a width, broken between words."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\n".join(lines)
