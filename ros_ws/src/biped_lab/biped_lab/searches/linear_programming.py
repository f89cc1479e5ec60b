"""The optimal open-loop plan by linear programming: an upper reference, not a learner.

    python -m biped_lab.searches.linear_programming

It knows the plant that the others have to find out about. A waist correction d moves
the ZMP by 0.83 d - 0.051 d'' (docs/design.md, "Corrections"); d is measured from the
plant's own B-spline, and the ZMP error without correction from a static walk of the
links as point masses (the kinematic engine), where nothing falls. Minimised are the
largest errors along x and along y, one apart from the other. The plan has a correction
per learning tick, as learners decide; it is rounded to the alternatives and walked.

The command prints the table of the four difficulties, in Markdown.
"""

from __future__ import annotations

import sys
from contextlib import closing
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

from biped_bringup.run_settings import RunSettings, load_settings
from biped_bringup.walker import Walker
from biped_common.timing import (
    CONTROL_PERIOD_S,
    TICKS_PER_LEARNING_TICK,
    seconds,
)
from biped_lab.contestant import NoOptions
from biped_lab.searches.plan import COMPONENTS, PlanSpace
from biped_lab.searches.search_contestant import search_entry
from biped_lab.searches.searcher import Walked
from learner_node.walking.walks import static_walk
from sim_node.control_tick import ControlTick
from sim_node.settings import LimitSettings, SimSettings
from trajectory_node.bspline import CorrectionSpline

# Between learning ticks the response is nearly straight: these control ticks of each
# are rows of the program, from 0 for the first.
_ROWS_OF_A_TICK = (0, 4, 8)
_NO_LIMIT_M = 10.0
DOUBLE_SUPPORTS_S = (1.05, 0.90, 0.80, 0.70)
KNOT_SPACINGS_S = (0.4, 0.24)


class Optimum(NamedTuple):
    """The plan that the linear model likes best."""

    plan_m: NDArray[np.float64]
    """(points, 2), not rounded to the alternatives."""
    peak_m: NDArray[np.float64]
    """(2,) largest ZMP error along x and y that is left, at any control tick."""


def static_zmp_error(settings: RunSettings) -> NDArray[np.float64]:
    """Return the (ticks, 2) ZMP error of the walk without correction [m]."""
    nominal = SimSettings(
        engine="kinematic", limits=LimitSettings(zmp_error_m=_NO_LIMIT_M)
    )
    ticks: list[ControlTick] = []
    planned = replace(settings, sim=nominal)
    walker = Walker(planned, np.random.default_rng(0), ticks.append)
    with closing(walker):
        walker.walk(static_walk(settings.learner, walker.walk_ticks))
    zmp_m = np.array([tick.contact[:2] for tick in ticks])
    reference_m = np.array([tick.zmp_reference for tick in ticks])
    error_m: NDArray[np.float64] = zmp_m - reference_m
    return error_m


def zmp_response(settings: RunSettings, space: PlanSpace) -> NDArray[np.float64]:
    """Return the (ticks, points) ZMP per correction of the linear model [m/m]."""
    ticks = settings.gait.walk_ticks
    one = _response_to_one_tick(settings, ticks)
    hold = settings.learner.action.hold_ticks * TICKS_PER_LEARNING_TICK
    response = np.zeros((ticks + 1, space.points))
    for tick in range(0, ticks, TICKS_PER_LEARNING_TICK):
        point = space.point_at(tick // hold * hold)
        response[tick:, point] += one[: ticks + 1 - tick]
    return response[1:]


def optimum(settings: RunSettings, space: PlanSpace) -> Optimum:
    """Return the plan with the smallest peak of the ZMP error."""
    error_m = static_zmp_error(settings)
    response = zmp_response(settings, space)
    rows = np.isin(np.arange(len(error_m)) % TICKS_PER_LEARNING_TICK, _ROWS_OF_A_TICK)
    plan_m = np.column_stack(
        [
            _smallest_peak(response[rows], error_m[rows, c], space.limit_m)
            for c in range(COMPONENTS)
        ]
    )
    return Optimum(plan_m, np.abs(error_m + response @ plan_m).max(axis=0))


class LinearProgram:
    """Proposes the optimal plan, whatever comes of it."""

    def __init__(self, settings: RunSettings, space: PlanSpace) -> None:
        """Solve the linear program."""
        self._plan_m = optimum(settings, space).plan_m

    def ask(self, points: int) -> NDArray[np.float64]:
        """Return the plan."""
        return self._plan_m

    def tell(self, walked: Walked) -> None:
        """Learn nothing."""


ENTRY = search_entry(
    __name__,
    NoOptions,
    lambda _, settings, space, rng: LinearProgram(settings, space),
    PlanSpace.of_learning_ticks,
)


def _response_to_one_tick(settings: RunSettings, ticks: int) -> NDArray[np.float64]:
    """Return the (ticks + 1,) ZMP after a correction of 1 m at learning tick 0 [m]."""
    rows = TICKS_PER_LEARNING_TICK
    spline = CorrectionSpline(settings.correction, rows)
    nowhere, none = np.zeros((rows, 3)), np.zeros(COMPONENTS)
    pushed = [spline.push(np.ones(COMPONENTS), nowhere)]
    while len(pushed) * rows < ticks + 2:
        pushed.append(spline.push(none, nowhere))
    d = np.concatenate(([0.0], *(each[:, 0] for each in pushed)))[: ticks + 3]
    acceleration = np.diff(d, 2) / CONTROL_PERIOD_S**2
    plant = settings.learner.blame
    return (
        plant.zmp_per_position * d[1:-1] + plant.zmp_per_acceleration_s2 * acceleration
    )


def _smallest_peak(
    response: NDArray[np.float64], error_m: NDArray[np.float64], limit_m: float
) -> NDArray[np.float64]:
    """Return the (points,) x within the limit with the least max |error + response x|.

    Args:
        response: (rows, points).
        error_m: (rows,) without correction.
        limit_m: of each x.
    """
    rows, points = response.shape
    peak = np.ones((rows, 1))
    solved = linprog(
        np.eye(points + 1)[-1],  # the last variable is the peak
        A_ub=np.block([[response, -peak], [-response, -peak]]),
        b_ub=np.concatenate((-error_m, error_m)),
        bounds=[(-limit_m, limit_m)] * points + [(0.0, None)],
        method="highs",
    )
    x: NDArray[np.float64] = solved.x[:points]
    return x


# -- the table -------------------------------------------------------------------------


@dataclass(frozen=True)
class Row:
    """One difficulty at one knot spacing, lateral ZMP errors [m]."""

    double_support_s: float
    knot_spacing_s: float
    static_m: float
    """Without correction."""
    tick_m: float
    """Optimum of a correction per learning tick."""
    knot_m: float
    """Optimum of a correction per knot spacing, as the searchers' plans."""
    walked_s: float
    """The first of these optima, on full physics."""
    end_cause: str
    peak_m: float
    """Norm of the ZMP error there."""

    def __str__(self) -> str:
        lengths = (self.static_m, self.tick_m, self.knot_m, self.peak_m)
        static, tick, knot, peak = (f"{1000 * length:.1f}" for length in lengths)
        return (
            f"| {self.double_support_s:.2f} | {self.knot_spacing_s:g} | {static} "
            f"| {tick} | {knot} | {self.walked_s:.2f} | {self.end_cause} | {peak} |"
        )


def difficulty(double_support_s: float, knot_spacing_s: float) -> Row:
    """Solve and walk one difficulty; the rest is the preset `paper`."""
    settings = load_settings(
        changes=(
            f"gait.double_support_s={double_support_s}",
            f"correction.knot_spacing_s={knot_spacing_s}",
        )
    )
    by_tick, by_knot = (
        optimum(settings, space).peak_m[1]
        for space in (
            PlanSpace.of_learning_ticks(settings),
            PlanSpace.of_knots(settings),
        )
    )
    with closing(ENTRY.begin(settings, NoOptions(), 0)) as contestant:
        contestant.episode()
        table = contestant.table()
    return Row(
        double_support_s,
        knot_spacing_s,
        static_m=float(np.abs(static_zmp_error(settings)[:, 1]).max()),
        tick_m=float(by_tick),
        knot_m=float(by_knot),
        walked_s=seconds(int(table["control_ticks"][0])),
        end_cause=str(table["end_cause"][0]),
        peak_m=float(table["peak_zmp_error_m"][0]),
    )


def main() -> int:
    """Print the table."""
    print(
        "| T_ds [s] | h [s] | static [mm] | per learning tick [mm] | per knot [mm] "
        "| walked [s] | end | peak there [mm] |"
    )
    print("|---" * 8 + "|")
    for double_support_s in DOUBLE_SUPPORTS_S:
        for knot_spacing_s in KNOT_SPACINGS_S:
            print(difficulty(double_support_s, knot_spacing_s), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
