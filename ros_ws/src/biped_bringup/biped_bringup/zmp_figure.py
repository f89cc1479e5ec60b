"""The picture of a walk: where the ZMP was, and where it should have been."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.settings import RobotSettings
from sim_node.control_tick import ControlTick
from sim_node.settings import LimitSettings
from trajectory_node.gait import GaitPlan

FIGURE_SUFFIXES = (".png", ".pdf", ".svg")
_MEASURED, _REFERENCE, _LIMIT, _SHADE = "#1f6fb4", "#e08214", "#b2182b", "#e8eef4"


class ZmpTrace:
    """Measured ZMP and its error at every control tick of a walk."""

    def __init__(self) -> None:
        """Start empty."""
        self.zmp_m: list[tuple[float, float]] = []
        self.error_m: list[float] = []

    def add(self, tick: ControlTick) -> None:
        """Take a control tick; fits as the robot's `on_tick`."""
        self.zmp_m.append((tick.contact.zmp_x_m, tick.contact.zmp_y_m))
        self.error_m.append(tick.zmp_error_m)


def draw_zmp(
    trace: ZmpTrace,
    plan: GaitPlan,
    robot: RobotSettings,
    limits: LimitSettings,
    path: Path,
) -> None:
    """Draw the walk from above, its ZMP over time, and the ZMP error with its limit.

    Args:
        trace: of the walk.
        plan: what it should have been.
        robot: dimensions of its soles.
        limits: the failure limit drawn.
        path: the picture; its suffix gives the format.
    """
    n = len(trace.error_m)
    time_s = CONTROL_PERIOD_S * np.arange(1, n + 1)
    measured = np.array(trace.zmp_m).reshape(n, 2)
    reference = plan.zmp_reference[1 : n + 1]
    figure = Figure(figsize=(9.0, 9.0), layout="constrained")
    FigureCanvasAgg(figure)
    above, over_time, error = figure.subplots(3, 1, height_ratios=(1.3, 1.0, 1.0))

    for x, y in _footholds(plan):
        above.add_patch(
            Rectangle(
                (x + robot.sole_ahead_of_ankle_m - robot.sole_length_m / 2,
                 y - robot.sole_width_m / 2),
                robot.sole_length_m, robot.sole_width_m,
                facecolor=_SHADE, edgecolor="#8899aa", linewidth=0.8,
            )
        )  # fmt: skip
    above.plot(*plan.zmp_reference.T, color=_REFERENCE, label="reference")
    above.plot(*measured.T, color=_MEASURED, linewidth=0.9, label="measured")
    above.set(aspect="equal", xlabel="x [m], forward", ylabel="y [m], left")
    above.set_title("ZMP from above, with the soles' footholds")
    above.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)

    for axis, name, style in ((0, "x", "-"), (1, "y", "--")):
        over_time.plot(time_s, reference[:, axis], style, color=_REFERENCE)
        over_time.plot(
            time_s, measured[:, axis], style, color=_MEASURED, linewidth=0.9, label=name
        )
    over_time.set(
        ylabel="ZMP [m]", title="ZMP over time (blue measured, orange reference)"
    )
    over_time.legend(loc="upper left", frameon=False)

    error.plot(time_s, 1000.0 * np.array(trace.error_m), color=_MEASURED, linewidth=0.9)
    error.axhline(1000.0 * limits.zmp_error_m, color=_LIMIT, linestyle=":")
    error.set(ylabel="ZMP error [mm]", xlabel="time [s]", ylim=(0.0, None))
    error.set_title("norm of the ZMP error; dotted: failure; shaded: double support")
    double = plan.double_support[: n + 1]
    edges = np.flatnonzero(np.diff(np.concatenate([[False], double, [False]])))
    for start, end in edges.reshape(-1, 2):
        for axes in (over_time, error):
            axes.axvspan(
                start * CONTROL_PERIOD_S, end * CONTROL_PERIOD_S, color=_SHADE, zorder=0
            )
    for axes in (over_time, error):
        axes.set_xlim(0.0, plan.ticks * CONTROL_PERIOD_S)
    figure.savefig(path, dpi=120)


def _footholds(plan: GaitPlan) -> set[tuple[float, float]]:
    """Return the (x, y) where a foot stands at some time, to the millimetre."""
    return {
        (round(float(x), 3), round(float(y), 3))
        for foot in (plan.left_foot, plan.right_foot)
        for x, y, z in foot[plan.double_support]
        if z == 0.0
    }
