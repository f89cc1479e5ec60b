"""Figures of who chose the corrections: its states, and how it came to them."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from biped_common.colours import BLUE, GREEN, GREY, SKY, VERMILLION
from biped_common.timing import CONTROL_PERIOD_S
from biped_lab.report.theme import new_figure
from learner_node.walking.episode_log import EpisodeLog
from learner_node.walking.waist_plane import LearnedStates
from msgs_json.end_cause import EndCause

_COMPLETED = tuple(EndCause).index(EndCause.COMPLETED)


_STYLES: dict[str, dict[str, Any]] = {
    "exploring": {"marker": "o", "color": SKY, "markersize": 5.0},
    "fixed": {"marker": "s", "color": GREEN, "markersize": 5.0},
    "penalty": {"marker": "X", "color": VERMILLION, "markersize": 6.5},
}


def draw_states(states: LearnedStates) -> Figure:
    """Draw the states by their mode, from above, the robot walking up the page."""
    figure = new_figure(3.2)
    axes = figure.subplots()
    axes.plot(0.0, 0.0, "+", color=GREY, markersize=9.0, label="ankle of support foot")
    for mode, which in states.modes.items():
        x, y = states.waist_m[which].T
        axes.plot(
            y, x, linestyle="", alpha=0.75, label=f"{mode}: {which.sum()}",
            **_STYLES[mode],
        )  # fmt: skip
    axes.margins(0.08)
    axes.invert_xaxis()
    axes.set(aspect="equal", xlabel="waist y [m], left", ylabel="waist x [m], forward")
    figure.legend(loc="outside upper left", ncols=4)
    return figure


def draw_learning_curve(log: EpisodeLog) -> Figure:
    """Draw how long each episode walked, against the target time it had."""
    figure = new_figure(3.0)
    axes = figure.subplots()
    columns = log.arrays()
    episode = np.arange(1, len(log) + 1)
    walked_s = CONTROL_PERIOD_S * columns["control_ticks"]
    reached = columns["end_cause"] == _COMPLETED
    axes.step(
        episode, CONTROL_PERIOD_S * columns["target_ticks"], where="mid", color=BLUE,
        label="target time",
    )  # fmt: skip
    for which, colour, marker, name in (
        (reached, GREEN, "o", f"reached it: {reached.sum()}"),
        (~reached, VERMILLION, "x", f"failed before: {(~reached).sum()}"),
    ):
        axes.plot(
            episode[which], walked_s[which], marker, color=colour, markersize=3.5,
            label=name,
        )  # fmt: skip
    axes.set(xlabel="episode", ylabel="walked [s]", ylim=(0.0, None))
    figure.legend(loc="outside upper left", ncols=3)
    return figure
