"""What is drawn around the robot: floor, soles, support, ZMP and limit, waist paths.

What lies on the floor lies a little above it, one above the other, so that nothing
flickers. ZMP, limit and outlines are drawn above the soles, which would hide them.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull

from biped_description.settings import RobotSettings
from biped_view.theme import Theme

Array = NDArray[np.float64]

# Heights above the floor, or, of what would be hidden, above the soles on it [m].
_SUPPORT_Z, _OUTLINE_Z, _LIMIT_Z = 0.001, 0.002, 0.003
_REFERENCE_Z, _ZMP_Z = 0.004, 0.006
_LINE_M: Final = 0.004
_DOT_M: Final = 0.012
_CIRCLE_POINTS: Final = 65
_LIMIT_OPACITY: Final = 0.25
_SUPPORT_OPACITY: Final = 0.55


class FloorScene:
    """The floor and what is marked on it and above; world frame [m]."""

    def __init__(
        self,
        scene: viser.SceneApi,
        sole_thickness_m: float,
        zmp_limit_m: float,
        theme: Theme,
    ) -> None:
        """Add the floor; what moves appears with its first place.

        Args:
            scene: of a viser server.
            sole_thickness_m: of the robot's feet; what they would hide is drawn above.
            zmp_limit_m: norm of the ZMP error at which the walk fails.
            theme: of all colours.
        """
        self._scene, self._lift_m = scene, sole_thickness_m
        self._zmp_limit_m, self._theme = zmp_limit_m, theme
        self._paths: dict[str, viser.LineSegmentsHandle] = {}
        self._corners: Array | None = None
        self.paint(theme)

    def paint(self, theme: Theme) -> None:
        """Draw in the colours of a theme, anew if need be."""
        self._theme = theme
        scene = self._scene
        for path in self._paths.values():
            path.remove()
        self._paths.clear()
        self._corners = None
        scene.add_grid(
            "/floor",
            infinite_grid=True,
            cell_size=0.1,
            section_size=0.5,
            cell_color=theme.soft,
            section_color=theme.soft,
            cell_thickness=0.6,
            section_thickness=1.2,
            fade_distance=6.0,
            plane_color=theme.paper,
            plane_opacity=1.0,
            shadow_opacity=0.15,
            position=(0.0, 0.0, -0.001),
        )
        self._reference = scene.add_frame(
            "/walk/reference", show_axes=False, visible=False
        )
        _flat_disc(
            scene, "/walk/reference/limit", self._zmp_limit_m, theme.limit, _LIMIT_Z
        )
        angles = np.linspace(0.0, 2 * np.pi, _CIRCLE_POINTS)
        ring = self._zmp_limit_m * np.column_stack((np.cos(angles), np.sin(angles)))
        self._line("/walk/reference/ring", _at(ring, _LIMIT_Z), theme.limit)
        scene.add_icosphere(
            "/walk/reference/dot",
            _DOT_M,
            theme.zmp_reference,
            scale=(1.0, 1.0, 0.2),
            position=(0.0, 0.0, _REFERENCE_Z),
            cast_shadow=False,
        )
        self._zmp = scene.add_icosphere(
            "/walk/zmp",
            _DOT_M,
            theme.zmp,
            scale=(1.0, 1.0, 0.2),
            cast_shadow=False,
            visible=False,
        )

    def place_zmp(self, measured_m: ArrayLike, reference_m: ArrayLike) -> None:
        """Move the measured ZMP, and its reference with the limit around it.

        Args:
            measured_m: (2,)
            reference_m: (2,)
        """
        self._zmp.position = np.array([*np.asarray(measured_m), self._lift_m + _ZMP_Z])
        self._reference.position = np.array([*np.asarray(reference_m), self._lift_m])
        if not self._zmp.visible:
            self._zmp.visible = self._reference.visible = True

    def place_support(self, corners_m: ArrayLike) -> None:
        """Draw the support polygon.

        Args:
            corners_m: (n, 2) points; their convex hull is drawn, nothing of none.
        """
        corners = np.asarray(corners_m, dtype=np.float64).reshape(-1, 2)
        if self._corners is not None and np.array_equal(corners, self._corners):
            return
        name, first = "/walk/support", self._corners is None
        self._corners = corners
        if not len(corners):
            if not first:
                self._scene.remove_by_name(name)
            return
        hull = corners[ConvexHull(corners).vertices]
        fan = np.array([(0, k, k + 1) for k in range(1, len(hull) - 1)])
        self._scene.add_mesh_simple(
            name,
            _at(hull, _SUPPORT_Z),
            fan,
            color=self._theme.support,
            opacity=_SUPPORT_OPACITY,
            side="double",
            cast_shadow=False,
        )
        outline = _at(_closed(hull), self._lift_m + _OUTLINE_Z)
        self._line(f"{name}/outline", outline, self._theme.support)

    def draw_path(self, which: str, points_m: ArrayLike) -> None:
        """Draw a path, in the colour of what it is.

        Args:
            which: a field of the theme: "static_waist", "waist", "waist_ahead", or,
                for the ways of the feet, "left" or "right".
            points_m: (n, 3) on the way; with fewer than two nothing is drawn.
        """
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 3)
        path = self._paths.get(which)
        if len(points) < 2:
            if path is not None:
                path.visible = False
            return
        if path is None:
            colour = getattr(self._theme, which)
            self._paths[which] = self._line(f"/walk/{which}", points, colour)
            return
        path.points = _segments(points).astype(np.float32)
        path.visible = True

    def _line(
        self, name: str, points: Array, colour: tuple[int, int, int]
    ) -> viser.LineSegmentsHandle:
        return self._scene.add_line_segments(
            name, _segments(points), colour, thickness=_LINE_M
        )


def sole_corners(robot: RobotSettings, feet_m: ArrayLike) -> Array:
    """Return the corners (4 n, 2) of soles that point ahead [m].

    Args:
        robot: dimensions of its soles.
        feet_m: (n, 2) or (n, 3) points of the soles under the ankle.
    """
    feet = np.asarray(feet_m, dtype=np.float64).reshape(-1, np.shape(feet_m)[-1])
    half_x, half_y = robot.sole_length_m / 2, robot.sole_width_m / 2
    ahead = robot.sole_ahead_of_ankle_m
    sole = np.array(
        [(ahead + x * half_x, y * half_y)
         for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    )  # fmt: skip
    corners: Array = feet[:, None, :2] + sole
    return corners.reshape(-1, 2)


def _closed(corners: Array) -> Array:
    return np.concatenate((corners, corners[:1]))


def _segments(points: Array) -> Array:
    """Return the (n - 1, 2, d) pieces of a path of (n, d) points."""
    return np.stack((points[:-1], points[1:]), axis=1)


def _at(points: Array, height_m: float) -> Array:
    """Return (n, 3) points above the floor of (n, 2) points on it."""
    return np.column_stack((points, np.full(len(points), height_m)))


def _flat_disc(
    scene: viser.SceneApi,
    name: str,
    radius_m: float,
    colour: tuple[int, int, int],
    height_m: float,
) -> None:
    scene.add_cylinder(
        name,
        radius_m,
        0.0005,
        colour,
        radial_segments=64,
        opacity=_LIMIT_OPACITY,
        position=(0.0, 0.0, height_m - 0.001),
        cast_shadow=False,
        receive_shadow=False,
    )
