"""Masses and inertias of the tables."""

from dataclasses import FrozenInstanceError

import numpy as np
import pytest

from biped_description.dimensions import BIPED, Box, Cylinder
from biped_description.links import LINK_MASSES, LINK_NAMES, LINKS


def test_the_robot_weighs_28_87_kg():
    assert BIPED.total_mass == pytest.approx(28.87, abs=1e-12)


def test_the_links_weigh_as_much_as_the_robot():
    assert LINK_MASSES.sum() == pytest.approx(BIPED.total_mass, abs=1e-12)


def test_every_link_has_a_name_of_its_own():
    assert len(set(LINK_NAMES)) == len(LINKS) == 13


def test_the_robot_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        BIPED.waist_height = 0.5  # type: ignore[misc]


def test_the_link_masses_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        LINK_MASSES[0] = 1.0


def test_knees_are_flexed_in_the_walking_posture():
    assert BIPED.waist_height < BIPED.stretched_leg_length


def test_a_box_turns_like_a_cloud_of_points_that_fills_it():
    box = Box(0.22, 0.14, 0.03)
    sides = (box.length_x, box.length_y, box.length_z)
    points = _grid(sides, points_per_side=40)
    assert box.inertia(0.7) == pytest.approx(_moments(points, 0.7), rel=2e-3)


def test_a_cylinder_turns_like_a_cloud_of_points_that_fills_it():
    cylinder = Cylinder(radius=0.045, length_z=0.24)
    width = 2 * cylinder.radius
    points = _grid((width, width, cylinder.length_z), points_per_side=60)
    inside = np.hypot(points[:, 0], points[:, 1]) <= cylinder.radius
    moments = _moments(points[inside], 2.5)
    assert cylinder.inertia(2.5) == pytest.approx(moments, rel=5e-3)


def _grid(sides: tuple[float, float, float], points_per_side: int) -> np.ndarray:
    """Cell centres (m, 3) of a box around the origin."""
    unit = (np.arange(points_per_side) + 0.5) / points_per_side - 0.5
    mesh = np.meshgrid(*(side * unit for side in sides), indexing="ij")
    return np.stack(mesh, axis=-1).reshape(-1, 3)


def _moments(points: np.ndarray, mass: float) -> list[float]:
    """Principal moments of equal point masses that add up to ``mass``."""
    xx, yy, zz = (points**2).mean(axis=0)
    return [mass * (yy + zz), mass * (xx + zz), mass * (xx + yy)]
