"""How a correction moves the ZMP: what directed blame knows of the plant."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.bspline import uniform_bspline
from biped_common.timing import LEARNING_PERIOD_S
from learner_node.walking.settings import BlameSettings


def zmp_response(settings: BlameSettings, hold_ticks: int) -> NDArray[np.float64]:
    """Return (ages,) how far a correction has moved the ZMP when it is so old [m/m].

    A waist correction d moves the ZMP by a d + b d'' (docs/design.md, "Corrections"),
    and d is a B-spline: at first the ZMP moves the other way. Ages are counted in
    decisions; the last one has age 0 and has been carried out in full. Older ones than
    these have no effect.

    Args:
        settings: the spline, a and b.
        hold_ticks: learning ticks that a decision is held.
    """
    h, order, period = settings.knot_spacing_s, settings.order, LEARNING_PERIOD_S
    ticks = math.ceil(round(order * h / period, 9))
    decisions = -(-ticks // hold_ticks)
    after_s = period * np.arange(1.0, decisions * hold_ticks + 1.0)

    def d(t: NDArray[Any]) -> NDArray[np.float64]:
        return (period / h) * uniform_bspline(t / h, order)

    # A quadratic spline's second derivative jumps: taken over a learning tick.
    half = 0.5 * period
    acceleration = (d(after_s + half) - 2.0 * d(after_s) + d(after_s - half)) / half**2
    per_tick = (
        settings.zmp_per_position * d(after_s)
        + settings.zmp_per_acceleration_s2 * acceleration
    )
    response: NDArray[np.float64] = per_tick.reshape(decisions, hold_ticks).sum(axis=1)
    return response
