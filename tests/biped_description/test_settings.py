"""The table of a robot: masses and inertias, and tables that are refused."""

import math
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from tests.robots import SHIPPED, TALL

from biped_common.settings import SettingsError, from_mapping, to_mapping
from biped_description.links import LINK_NAMES
from biped_description.robot import Robot
from biped_description.settings import RobotSettings
from biped_description.shapes import Box, Cylinder


@pytest.mark.parametrize(("robot", "mass_kg"), [(SHIPPED, 28.87), (TALL, 61.4)])
def test_a_robot_weighs_what_its_links_weigh(robot, mass_kg):
    assert robot.mass_kg == pytest.approx(mass_kg, abs=1e-12)


def test_every_link_has_its_name(robot):
    assert tuple(link.name for link in robot.links) == LINK_NAMES
    assert len(set(LINK_NAMES)) == 13


def test_a_robot_cannot_be_changed():
    with pytest.raises(FrozenInstanceError):
        SHIPPED.settings.thigh_length_m = 0.5  # type: ignore[misc]


def test_robots_of_one_table_are_equal():
    assert Robot(from_mapping(RobotSettings, to_mapping(TALL.settings))) == TALL


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"thigh_length_m": 0.0}, "thigh_length_m = 0.0: must be between 0.001 and"),
        ({"shank_length_m": -0.24}, "shank_length_m = -0.24: must be between"),
        ({"thigh_length_m": math.nan}, "thigh_length_m = nan: must be a finite number"),
        ({"foot_mass_kg": 0.0}, "foot_mass_kg = 0.0: must be between 0.001 and"),
        ({"torso_mass_kg": "heavy"}, "torso_mass_kg = 'heavy': must be a number"),
        ({"sole_thickness_m": 0.07}, "must be at most ankle_height_m = 0.06 m"),
        ({"limb_com_fraction": 1.1}, "limb_com_fraction = 1.1: must be between"),
        ({"torque_limit_nm": [40.0] * 5}, "must be 6 numbers: hip_yaw, hip_roll, "),
        ({"torque_limit_nm": [40.0] * 5 + [0.0]}, "must be above 0.0 N m"),
        ({"position_upper_rad": [0.5] * 5 + [-0.6]}, "ankle_roll must be above its "),
        ({"position_lower_rad": [-0.5] * 6}, "knee must be at least 0.0 rad"),
        ({"position_upper_rad": [3.1] * 6}, "must be between -3.0 and 3.0 rad"),
        ({"velocity_limit_rad_s": 0.0}, "must be above 0.0 rad/s"),
        ({"tail_length_m": 0.3}, "tail_length_m = 0.3: unknown key; known here: "),
    ],
)
def test_a_table_is_refused_in_one_line(table, message):
    with pytest.raises(SettingsError) as caught:
        from_mapping(RobotSettings, table)
    assert message in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


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
