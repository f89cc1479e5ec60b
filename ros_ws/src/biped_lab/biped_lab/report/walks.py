"""What the runs walked: why their episodes ended, and what replay saved of them."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from biped_common.colours import BLUE, GREEN, GREY, INK, PURPLE, SKY, VERMILLION, YELLOW
from biped_lab.report.finished import FinishedRuns
from biped_lab.report.theme import new_figure

_CAUSE_COLOURS = {
    "completed": GREEN,
    "zmp_error": VERMILLION,
    "joint_velocity": BLUE,
    "ik_unreachable": SKY,
    "ik_joint_limit": PURPLE,
    "torque_saturation": YELLOW,
}
_LABELLED_SHARE = 0.06


def end_causes(finished: FinishedRuns) -> pd.DataFrame:
    """Return the share of each end cause (columns) in the episodes of an arm (rows)."""
    shares = {
        arm: pd.concat(finished.tables_of(arm))["end_cause"].value_counts(
            normalize=True
        )
        for arm in finished.arms
    }
    found = pd.DataFrame(shares).T.fillna(0.0)
    order = [cause for cause in _CAUSE_COLOURS if cause in found]
    return found[order + sorted(set(found) - set(order))]


def draw_end_causes(finished: FinishedRuns) -> Figure:
    """Draw the shares, one bar an arm."""
    shares = end_causes(finished)
    figure = new_figure(0.9 + 0.32 * len(shares))
    axes = figure.subplots()
    left = np.zeros(len(shares))
    titles = [finished.arrangement.title(arm) for arm in finished.arms]
    for cause, share in shares.items():
        colour = _CAUSE_COLOURS.get(str(cause), GREY)
        drawn = axes.barh(
            titles, share, left=left, color=colour, alpha=0.75, height=0.7,
            label=str(cause).replace("_", " "),
        )  # fmt: skip
        labels = [f"{100 * s:.0f} %" if s >= _LABELLED_SHARE else "" for s in share]
        axes.bar_label(drawn, labels, label_type="center", fontsize=7.5, color=INK)
        left += share.to_numpy()
    axes.invert_yaxis()
    axes.set_xlim(0.0, 1.0)
    axes.set_xlabel("share of all learning episodes [ ]")
    axes.tick_params(axis="y", length=0.0)
    axes.legend(
        loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5, borderaxespad=0.2,
        columnspacing=1.2, handlelength=1.2,
    )  # fmt: skip
    return figure


def never_interrupted(finished: FinishedRuns) -> pd.DataFrame:
    """Return the runs whose computed time does not depend on interruptions."""
    return finished.runs[finished.runs["sittings"] == 1]


def draw_replay(finished: FinishedRuns) -> Figure:
    """Draw what the physics computed of what was walked, run by run."""
    runs = never_interrupted(finished)
    rows = math.ceil(len(finished.arms) / _LEGEND_COLUMNS)
    many = len(finished.arms) > _MOST_BESIDE
    figure = new_figure(3.9 + 0.2 * rows * many)
    axes = figure.subplots()
    alike: Counter[str] = Counter()
    for arm in finished.arms:
        own = runs[runs["arm"] == arm]
        colour = finished.arrangement.colours[arm]
        marker = _MARKERS[alike[colour] % len(_MARKERS)]
        alike[colour] += 1
        if own.empty:
            continue
        axes.plot(
            own["simulated_s"] + own["evaluation_s"],
            own["computed_s"],
            marker,
            markerfacecolor=colour,
            markeredgecolor=INK,
            markeredgewidth=0.5,
            markersize=5.0,
            alpha=0.85,
            label=finished.arrangement.title(arm),
        )
    walked = runs["simulated_s"] + runs["evaluation_s"]
    ends = np.array([0.8 * walked.min(), 1.25 * walked.max()])
    for part, text in ((1.0, "all computed"), (0.1, "a tenth")):
        axes.plot(ends, part * ends, color=GREY, linewidth=0.9, zorder=0.5)
        axes.annotate(
            text, (ends[1], part * ends[1]), color=GREY, fontsize=7.5, va="center",
            xytext=(3, 0), textcoords="offset points",
        )  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter(NullFormatter())
    axes.set_xlabel("walked: simulated time, frozen trials included [s]")
    axes.set_ylabel("computed by the physics [s]")
    if many:
        figure.legend(loc="outside lower center", ncols=_LEGEND_COLUMNS)
    else:
        axes.legend(loc="center left", bbox_to_anchor=(1.1, 0.5))
    return figure


_MARKERS = "osD^vPX"
"""Arms of the same colour differ in these."""
_MOST_BESIDE, _LEGEND_COLUMNS = 14, 3
