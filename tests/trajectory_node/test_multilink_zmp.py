"""The kinematic ZMP against motions whose ZMP is known."""

import numpy as np
import pytest
from tests.robots import SHIPPED

from trajectory_node.gait import plan_gait
from trajectory_node.multilink_zmp import multilink_zmp
from trajectory_node.settings import GaitSettings
from trajectory_node.static_waist import static_waist

G = 9.81  # [m/s^2]
DT = 0.002  # [s]
N = 40
# A pose with nothing symmetric about it, held while the waist moves.
POSE = np.random.default_rng(4).uniform(
    SHIPPED.position_lower_rad, SHIPPED.position_upper_rad
)
HELD = np.tile(POSE, (N, 1))


def zmp_of(waist: np.ndarray, q: np.ndarray) -> np.ndarray:
    return multilink_zmp(SHIPPED, waist, q, DT)


def accelerating(x: float, y: float, z: float) -> np.ndarray:
    """Return a waist (N, 3) that takes off from rest with this acceleration."""
    t = DT * np.arange(N)[:, None]
    return np.array([0.1, -0.2, 0.5]) + 0.5 * t**2 * (x, y, z)


def static_walk_zmp_error(double_support_s: float) -> np.ndarray:
    """Return the norm of the static walk's ZMP error at every tick [m]."""
    settings = GaitSettings(double_support_s=double_support_s)
    plan = plan_gait(settings, SHIPPED.settings)
    waist = static_waist(SHIPPED, plan, settings.waist_height_m)
    q = SHIPPED.leg_joint_positions(waist, plan.left_foot, plan.right_foot)
    return np.linalg.norm(zmp_of(waist, q) - plan.zmp_reference, axis=1)


def test_the_zmp_of_a_standing_robot_is_under_its_com():
    waist = accelerating(0.0, 0.0, 0.0)
    expected = SHIPPED.com_position(waist, HELD)[:, :2]
    np.testing.assert_allclose(zmp_of(waist, HELD), expected, atol=1e-12)


@pytest.mark.parametrize(
    "acceleration",
    [(1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.0, 0.0, 3.0), (1.0, 2.0, -4.0)],
)
def test_the_zmp_of_a_rigid_push_lags_by_height_over_gravity(acceleration):
    waist = accelerating(*acceleration)
    com = SHIPPED.com_position(waist, HELD)
    horizontal, vertical = np.array(acceleration[:2]), G + acceleration[2]
    expected = com[:, :2] - horizontal * com[:, 2:] / vertical
    np.testing.assert_allclose(zmp_of(waist, HELD), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("double_support_s", "peak_mm"), [(1.05, 67.0), (1.00, 74.0), (0.90, 91.0)]
)
def test_the_static_walk_misses_its_zmp_the_more_the_faster_it_is(
    double_support_s, peak_mm
):
    error_mm = 1000 * static_walk_zmp_error(double_support_s)
    assert error_mm.max() == pytest.approx(peak_mm, abs=2.0)
