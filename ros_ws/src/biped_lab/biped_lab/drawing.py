"""A picture of the robot by its own kinematics: from the right, and from above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from numpy.typing import NDArray

from biped_description.joints import HIP_PITCH, HIP_ROLL, JOINTS_PER_LEG
from biped_description.robot import Robot

_SIZE_IN, _DPI = (8.0, 4.0), 80
_LEFT, _RIGHT, _BODY = "#0072b2", "#d55e00", "#333333"  # told apart by the colour-blind
_VIEW_M = 0.75
"""Half of the ground that is seen."""


class Scene(NamedTuple):
    """What there is to see at one control tick, world frame [m]."""

    waist: Sequence[float]
    """(3,) middle of the hip line."""
    joint_position: Sequence[float]
    """(12,) [rad]"""
    zmp: Sequence[float]
    """(2,) measured."""
    zmp_reference: Sequence[float]
    """(2,)"""


def picture(robot: Robot, scene: Scene, zmp_limit_m: float) -> NDArray[np.uint8]:
    """Return (height, width, 3) pixels."""
    figure = Figure(figsize=_SIZE_IN, dpi=_DPI, layout="constrained")
    side, above = figure.subplots(1, 2)
    waist = np.array(scene.waist)
    legs = _legs(robot, waist, np.array([scene.joint_position]))
    _draw_side(side, robot, waist, legs)
    _draw_above(above, robot, scene, legs, zmp_limit_m)
    for axes, label in ((side, "z [m]"), (above, "y [m]")):
        axes.set_xlim(waist[0] - _VIEW_M, waist[0] + _VIEW_M)
        axes.set_xlabel("x [m]")
        axes.set_ylabel(label)
        axes.set_aspect("equal")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()  # type: ignore[no-untyped-call]
    rgba = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
    return rgba[:, :, :3].copy()


def _legs(
    robot: Robot, waist: NDArray[np.float64], q: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Return hip, knee, ankle and foot (4, 3) of either leg, by its colour.

    The yaw joints stand still, as in every walk.
    """
    settings, legs = robot.settings, {}
    for first, colour, sign, foot in zip(
        (0, JOINTS_PER_LEG),
        (_LEFT, _RIGHT),
        (1.0, -1.0),
        robot.waist_to_feet(q),
        strict=True,
    ):
        roll, pitch = q[0, first + HIP_ROLL], q[0, first + HIP_PITCH]
        up_the_thigh = np.array(
            (np.sin(pitch), -np.sin(roll) * np.cos(pitch), np.cos(roll) * np.cos(pitch))
        )
        hip = waist + np.array((0.0, sign * settings.half_hip_spacing_m, 0.0))
        knee = hip - settings.thigh_length_m * up_the_thigh
        ankle = waist + foot[0] + np.array((0.0, 0.0, settings.ankle_height_m))
        legs[colour] = np.array([hip, knee, ankle, waist + foot[0]])
    return legs


def _draw_side(
    axes: Axes,
    robot: Robot,
    waist: NDArray[np.float64],
    legs: dict[str, NDArray[np.float64]],
) -> None:
    axes.axhline(0.0, color="0.6", linewidth=1.0)
    shoulders = waist + np.array((0.0, 0.0, _torso_height_m(robot)))
    axes.plot(*np.array([waist, shoulders])[:, [0, 2]].T, color=_BODY, linewidth=8.0)
    for colour, leg in legs.items():
        axes.plot(*leg[:3, [0, 2]].T, "o-", color=colour, linewidth=5.0)
        axes.plot(*_sole(robot, leg[3])[[0, 1]][:, [0, 2]].T, color=colour, linewidth=6)
    axes.set_ylim(-0.1, waist[2] + _torso_height_m(robot) + 0.1)
    axes.set_title("from the right")


def _draw_above(
    axes: Axes,
    robot: Robot,
    scene: Scene,
    legs: dict[str, NDArray[np.float64]],
    zmp_limit_m: float,
) -> None:
    for colour, leg in legs.items():
        sole = _sole(robot, leg[3])
        axes.fill(sole[:, 0], sole[:, 1], color=colour, alpha=0.4, linewidth=0.0)
    axes.add_patch(
        Circle(
            (scene.zmp_reference[0], scene.zmp_reference[1]),
            zmp_limit_m,
            fill=False,
            color=_BODY,
            linestyle="--",
            label="limit of the ZMP",
        )
    )
    axes.plot(*scene.zmp_reference[:2], "+", color=_BODY, label="reference ZMP")
    axes.plot(*scene.zmp[:2], "x", color="#cc79a7", markersize=9.0, label="ZMP")
    axes.plot(*scene.waist[:2], "s", color="#009e73", label="waist")
    axes.set_ylim(-0.4, 0.4)
    axes.legend(loc="upper left", fontsize="x-small", ncols=2)
    axes.set_title("from above")


def _torso_height_m(robot: Robot) -> float:
    """Return how far the top of the torso lies above the waist."""
    settings = robot.settings
    return settings.torso_com_height_m + 0.5 * settings.torso_height_m


def _sole(robot: Robot, foot: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the (4, 3) corners of a flat sole, heel and toe first."""
    settings = robot.settings
    x, y = 0.5 * settings.sole_length_m, 0.5 * settings.sole_width_m
    corners = [(-x, -y, 0.0), (x, -y, 0.0), (x, y, 0.0), (-x, y, 0.0)]
    ahead = np.array((settings.sole_ahead_of_ankle_m, 0.0, 0.0))
    return np.asarray(foot + np.array(corners) + ahead)
