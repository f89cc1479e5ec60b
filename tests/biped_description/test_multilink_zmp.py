"""The kinematic ZMP of motions whose ZMP is known."""

import numpy as np
import pytest

from biped_description.multilink_zmp import multilink_zmp

G = 9.81  # [m/s^2]
DT = 0.002  # [s]
NO_FORCE = (0.0, 0.0, 1.0)


@pytest.fixture(scope="module")
def coms(robot) -> np.ndarray:
    """CoMs (13, 3) of a pose with nothing symmetric about it."""
    limits = robot.position_lower_rad, robot.position_upper_rad
    q = np.random.default_rng(4).uniform(*limits)
    return robot.link_com_positions([[0.1, -0.2, 0.5]], [q])[0]


def zmp(robot, coms, acceleration=(0.0, 0.0, 0.0), force=NO_FORCE):
    """Return the ZMP of a robot that takes off from rest as a rigid body."""
    before = coms - DT * np.array([0.3, 0.2, 0.1])  # moving evenly until now
    after = 2.0 * coms - before + DT**2 * np.array(acceleration)
    return multilink_zmp(before, coms, after, DT, robot.link_masses_kg, *force)


def com(robot, coms):
    return robot.link_masses_kg @ coms / robot.mass_kg


def test_the_zmp_of_an_even_motion_is_under_the_com(robot, coms):
    expected = com(robot, coms)[:2]
    np.testing.assert_allclose(zmp(robot, coms)[:2], expected, rtol=0, atol=1e-9)


def test_the_floor_carries_the_weight(robot, coms):
    assert zmp(robot, coms)[2] == pytest.approx(G * robot.mass_kg)


@pytest.mark.parametrize(
    "acceleration",
    [(1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.0, 0.0, 3.0), (1.0, 2.0, -4.0)],
)
def test_the_zmp_of_a_rigid_push_lags_by_height_over_gravity(robot, coms, acceleration):
    x, y, z = com(robot, coms)
    ax, ay, az = acceleration
    expected = x - ax * z / (G + az), y - ay * z / (G + az), robot.mass_kg * (G + az)
    np.testing.assert_allclose(zmp(robot, coms, acceleration), expected, atol=1e-7)


def test_a_force_from_outside_shifts_the_zmp_by_its_moment_over_the_load(robot, coms):
    shift = np.subtract(zmp(robot, coms, force=(6.0, -8.0, 0.7)), zmp(robot, coms))
    expected = np.array([6.0, -8.0, 0.0]) * 0.7 / (G * robot.mass_kg)
    np.testing.assert_allclose(shift, expected, rtol=0, atol=1e-12)


def test_where_the_floor_would_have_to_pull_there_is_no_zmp(robot, coms):
    x, y, vertical = zmp(robot, coms, (1.0, 0.0, -G - 1.0))
    assert (x, y) == (0.0, 0.0)
    assert vertical == pytest.approx(-robot.mass_kg)
