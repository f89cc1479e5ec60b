"""Which figures a walk's report has, in which order, and what their captions say."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from biped_view.report.learner_figures import (
    draw_learning_curve,
    draw_states,
)
from biped_view.report.walk_figures import (
    draw_cost,
    draw_from_above,
    draw_joints,
    draw_waist,
    draw_zmp_error,
)
from biped_view.walk_record import LoadedWalk
from learner_node.walking.session import LearningSession
from learner_node.walking.waist_plane import learned_states


class ReportFigure(NamedTuple):
    """A figure with what is said above and below it."""

    name: str
    title: str
    caption: str
    figure: Figure


def figures(walk: LoadedWalk) -> Iterator[ReportFigure]:
    """Yield the figures of a walk and, where it had one, of its learner."""
    record = walk.record
    if np.isfinite(record.zmp_error_m).any():
        yield ReportFigure(
            "from_above",
            "Feet and ZMP from above",
            "Soles where the plan puts them, with the support polygon of each phase as "
            "far as it was walked; the dot is the last ZMP, the circle its limit then.",
            draw_from_above(record),
        )
        yield ReportFigure(
            "zmp_error",
            "ZMP error",
            "Measured minus reference ZMP. The walk fails where the norm reaches the "
            "limit. Above: which leg the plan stands on; shaded: both.",
            draw_zmp_error(record),
        )
    yield ReportFigure(
        "waist",
        "Waist: static against corrected",
        "The waist reference, the middle of the hip line, with and without "
        "corrections. Below: thin, what was chosen in each learning tick; bold, what "
        "the spline makes of it.",
        draw_waist(record),
    )
    yield ReportFigure(
        "joints",
        "Joints",
        "Measured angles, velocities and servo torques, with their limits; that of all "
        f"velocities, {record.robot.velocity_limit_rad_s:.1f} rad/s, is far above what "
        "is shown.",
        draw_joints(record),
    )
    if record.result is not None and record.result.cost is not None:
        yield ReportFigure(
            "t_err",
            "T_err by term",
            f"The six terms of eq. (2) add up to {record.result.cost.total:.4f}: what "
            "this walk cost. Less is better.",
            draw_cost(record.result.cost),
        )
    if walk.session is not None:
        yield from _of_learner(walk.session)


def _of_learner(session: LearningSession) -> Iterator[ReportFigure]:
    states = learned_states(session)
    if len(states.waist_m):
        yield ReportFigure(
            "states",
            "The learner's states",
            "Centres of the basis functions over the waist plane, relative to the "
            "support foot. Phase, ZMP error and acceleration, in which states differ, "
            "too, are not seen: several can lie upon each other.",
            draw_states(states),
        )
    if session.episodes:
        yield ReportFigure(
            "learning_curve",
            "Learning curve",
            "How long each learning episode walked, against the target time that it "
            "had. Frozen trial walks are not among them.",
            draw_learning_curve(session.log),
        )
