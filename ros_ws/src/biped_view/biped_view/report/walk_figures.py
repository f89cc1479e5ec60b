"""Figures of the walk: from above, ZMP error, waist, joints, and what it cost."""

from __future__ import annotations

import msgspec
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Patch, Polygon
from numpy.typing import NDArray

from biped_common.colours import BLUE, GREEN, GREY, PURPLE, SKY, VERMILLION
from biped_common.timing import CONTROL_PERIOD_S, seconds
from biped_description.joints import JOINTS_PER_LEG, LEG_JOINTS
from biped_description.robot import Robot
from biped_lab.report.theme import new_figure
from biped_view.phases import phases, short_name, standing_feet
from biped_view.walk_record import Rows, WalkRecord
from msgs_json.episode_result import CostTerms
from sim_node.markers import support_polygon

_MM = 1000.0
_THIN = 0.9
_LEAST_SHIFT_MM, _LEAST_VELOCITY_RAD_S = 5.0, 0.1


def draw_from_above(record: WalkRecord) -> Figure:
    """Draw soles, support polygons and ZMP on the floor, the robot walking right."""
    figure = new_figure(3.4)
    axes = figure.subplots()
    for phase in phases(record):
        feet = standing_feet(record, phase.last)
        axes.add_patch(
            Polygon(
                support_polygon(record.robot, feet), facecolor=SKY, alpha=0.22,
                edgecolor="none", zorder=0,
            )
        )  # fmt: skip
        for foot in feet:
            sole = support_polygon(record.robot, [foot])
            axes.add_patch(Polygon(sole, fill=False, edgecolor=GREY, linewidth=_THIN))
    axes.plot(*_known(record.zmp_reference_m).T, color=BLUE, label="reference ZMP")
    axes.plot(
        *_known(record.zmp_m).T, color=VERMILLION, linewidth=_THIN, label="measured ZMP"
    )
    reference, measured = _last(record.zmp_reference_m), _last(record.zmp_m)
    axes.add_patch(
        Circle(
            (reference[0], reference[1]), record.zmp_limit_m, fill=False,
            edgecolor=PURPLE, linestyle="--", linewidth=1.2,
        )
    )  # fmt: skip
    axes.plot(*measured, "o", color=VERMILLION, markersize=4.0)
    handles, labels = axes.get_legend_handles_labels()
    handles += [
        Patch(facecolor=SKY, alpha=0.4),
        Patch(fill=False, edgecolor=GREY),
        Patch(fill=False, edgecolor=PURPLE, linestyle="--"),
    ]
    labels += ["support polygons", "soles", "limit at the end"]
    figure.legend(handles, labels, loc="outside upper left", ncols=5)
    axes.autoscale_view()
    axes.set(aspect="equal", xlabel="x [m], forward", ylabel="y [m], left")
    return figure


def draw_zmp_error(record: WalkRecord) -> Figure:
    """Draw the norm of the ZMP error and its components over time, with the limit."""
    figure = new_figure(3.0)
    axes = figure.subplots()
    time_s, error = _known_at(_MM * record.zmp_error_m)
    axes.axhline(0.0, color=GREY, linewidth=0.6)
    axes.plot(time_s, error[:, 0], color=BLUE, linewidth=_THIN, label="x, forward")
    axes.plot(time_s, error[:, 1], color=GREEN, linewidth=_THIN, label="y, left")
    axes.plot(time_s, np.hypot(*error.T), color=VERMILLION, label="norm")
    limit = _MM * record.zmp_limit_m
    axes.axhline(
        limit, color=PURPLE, linestyle="--", linewidth=1.2, label=f"limit, {limit:g} mm"
    )
    axes.set(ylabel="ZMP error [mm]", xlabel="time [s]")
    _shade_phases(axes, record)
    figure.legend(loc="outside upper left", ncols=4)
    return figure


def draw_waist(record: WalkRecord) -> Figure:
    """Draw the waist over time, static and corrected, and the shift between them."""
    figure = new_figure(5.2)
    *ways, shifted = figure.subplots(3, 1, sharex=True)
    for axis, (panel, name) in enumerate(
        zip(ways, ("x [m], forward", "y [m], left"), strict=True)
    ):
        time_s, static_m = _known_at(record.static_waist_m[:, axis : axis + 1])
        panel.plot(time_s, static_m, color=GREY, linestyle="--", label="static")
        time_s, waist_m = _known_at(record.waist_m[:, axis : axis + 1])
        panel.plot(time_s, waist_m, color=GREEN, label="corrected")
        panel.set_ylabel(name)
        _shade_phases(panel, record)
    chosen = _MM * record.correction_m
    shift = _MM * (record.waist_m - record.static_waist_m)[:, :2]
    shifted.axhline(0.0, color=GREY, linewidth=0.6)
    for axis, (colour, name) in enumerate(((BLUE, "dx"), (VERMILLION, "dy"))):
        time_s, steps = _known_at(chosen[:, axis : axis + 1])
        shifted.plot(time_s, steps, color=colour, linewidth=0.6, alpha=0.5)
        time_s, smooth = _known_at(shift[:, axis : axis + 1])
        shifted.plot(time_s, smooth, color=colour, label=name)
    _at_least(shifted, _LEAST_SHIFT_MM)
    shifted.set_ylabel("correction [mm]")
    _shade_phases(shifted, record)
    shifted.set_xlabel("time [s]")
    figure.align_ylabels()
    handles = [
        handle
        for panel in (ways[0], shifted)
        for handle in panel.get_legend_handles_labels()[0]
    ]
    figure.legend(handles=handles, loc="outside upper left", ncols=4)
    return figure


def draw_joints(record: WalkRecord) -> Figure:
    """Draw angle, velocity and torque of each joint of a leg, left and right."""
    figure = new_figure(8.4)
    grid = figure.subplots(JOINTS_PER_LEG, 3, sharex=True)
    robot = Robot(record.robot)
    lower, upper, torque = (
        robot.position_lower_rad, robot.position_upper_rad, robot.torque_limit_nm
    )  # fmt: skip
    columns = ("angle [rad]", "velocity [rad/s]", "torque [N m]")
    for title, panels, values in zip(
        columns,
        grid.T,
        (
            record.joint_position_rad,
            record.joint_velocity_rad_s,
            record.joint_torque_nm,
        ),
        strict=True,
    ):
        panels[0].set_title(title)
        panels[-1].set_xlabel("time [s]")
        for joint, panel in enumerate(panels):
            for j, colour in ((joint, BLUE), (joint + JOINTS_PER_LEG, VERMILLION)):
                time_s, curve = _known_at(values[:, j : j + 1])
                panel.plot(time_s, curve, color=colour, linewidth=_THIN)
    for joint, (angles, velocities, torques) in enumerate(grid):
        angles.set_ylabel(LEG_JOINTS[joint].name.replace("_", " "))
        for panel, limits in (
            (angles, (lower[joint], upper[joint])),
            (torques, (-torque[joint], torque[joint])),
        ):
            for limit in limits:
                panel.axhline(limit, color=PURPLE, linestyle="--", linewidth=1.0)
        _at_least(velocities, _LEAST_VELOCITY_RAD_S)
    grid[0, 0].set_xlim(0.0, seconds(record.ticks))
    figure.align_ylabels(grid[:, 0])
    handles = [Patch(facecolor=BLUE), Patch(facecolor=VERMILLION),
               Patch(fill=False, edgecolor=PURPLE, linestyle="--")]  # fmt: skip
    figure.legend(
        handles, ("left leg", "right leg", "limit"), loc="outside upper left", ncols=3
    )
    return figure


def draw_cost(terms: CostTerms) -> Figure:
    """Draw the terms of T_err as bars with their values."""
    figure = new_figure(2.2)
    axes = figure.subplots()
    values = msgspec.to_builtins(terms)
    names = [name.replace("_", " ") for name in values]
    sizes = np.array(list(values.values()))
    axes.barh(names, sizes, color=BLUE, height=0.6)
    for row, size in enumerate(sizes):
        axes.annotate(
            f"{size:.4f}  ({size / sizes.sum():.0%})", (size, row), (4, 0),
            textcoords="offset points", va="center", fontsize=8.0,
        )  # fmt: skip
    axes.invert_yaxis()
    axes.margins(x=0.2)
    axes.set_xlabel("T_err []")
    return figure


# -- parts -----------------------------------------------------------------------------


def _shade_phases(axes: Axes, record: WalkRecord) -> None:
    """Shade double supports, and say above each phase which leg it stands on."""
    for phase in phases(record):
        begin, end = seconds(phase.first), seconds(phase.last + 1)
        if phase.double_support:
            axes.axvspan(begin, end, color=GREY, alpha=0.14, linewidth=0.0, zorder=0)
        if end - begin > 0.05 * seconds(record.ticks):
            axes.annotate(
                short_name(phase), ((begin + end) / 2, 1.0),
                xycoords=("data", "axes fraction"), xytext=(0, 2),
                textcoords="offset points", ha="center", fontsize=7.0, color=GREY,
            )  # fmt: skip
    axes.set_xlim(0.0, seconds(record.ticks))


def _at_least(panel: Axes, reach: float) -> None:
    """Let a panel show at least -reach to reach: rounding errors are no motion."""
    low, high = panel.get_ylim()
    panel.set_ylim(min(low, -reach), max(high, reach))


def _known(rows: Rows) -> Rows:
    """Return the rows that were recorded."""
    return rows[np.isfinite(rows).all(axis=1)]


def _known_at(rows: Rows) -> tuple[NDArray[np.float64], Rows]:
    """Return times [s] and values of the rows that were recorded."""
    known = np.flatnonzero(np.isfinite(rows).all(axis=1))
    time_s = np.asarray(CONTROL_PERIOD_S * (known + 1), dtype=np.float64)
    return time_s, rows[known]


def _last(rows: Rows) -> NDArray[np.float64]:
    known = _known(rows)
    return known[-1] if len(known) else np.full(rows.shape[1], np.nan)
