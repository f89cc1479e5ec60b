"""ZMP and loads from contact points."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_node.bullet_kernels import (
    DISTANCE,
    LINK_A,
    NORMAL_FORCE,
    POINT_ON_B,
    POINT_SIZE,
    sum_contact,
)
from sim_node.contact import FloorContact

LEFT, RIGHT = 5, 11
HELD = FloorContact(7.0, 8.0, 100.0, 100.0, 0.001)


def point(link, x, y, force, distance=0.0):
    """Return a contact point as Bullet lays it out."""
    point = np.full(POINT_SIZE, np.nan)
    point.view(np.int32)[LINK_A] = link
    point[POINT_ON_B : POINT_ON_B + 2] = x, y
    point[DISTANCE], point[NORMAL_FORCE] = distance, force
    return point


def link(point):
    return point.view(np.int32)[LINK_A]


def floor_contact(points):
    together = np.array(points).reshape(-1, POINT_SIZE)
    return FloorContact(*sum_contact(together, LEFT))


points = st.builds(
    point,
    link=st.sampled_from([LEFT, RIGHT]),
    x=st.floats(-1.0, 1.0),
    y=st.floats(-1.0, 1.0),
    force=st.floats(0.001, 1000.0),
    distance=st.floats(-0.01, 0.01),
)


def test_the_zmp_is_the_mean_of_the_points_weighted_by_force():
    contact = floor_contact(
        [point(LEFT, 0.0, 0.1, 30.0), point(RIGHT, 0.4, -0.1, 10.0)]
    )
    assert contact[:2] == pytest.approx((0.1, 0.05))


@settings(deadline=None, max_examples=50)
@given(st.lists(points, min_size=1, max_size=8))
def test_the_zmp_is_among_the_points(points):
    zmp_x = floor_contact(points).zmp_x_m
    xs = [each[POINT_ON_B] for each in points]
    assert min(xs) - 1e-12 <= zmp_x <= max(xs) + 1e-12


@settings(deadline=None, max_examples=50)
@given(st.lists(points, max_size=8))
def test_each_foot_carries_its_own_points(points):
    contact = floor_contact(points)
    left, right = (
        sum(each[NORMAL_FORCE] for each in points if link(each) == foot)
        for foot in (LEFT, RIGHT)
    )
    assert contact[2:4] == (pytest.approx(left), pytest.approx(right))


def test_a_point_without_force_does_not_count():
    pressing = point(LEFT, 0.1, 0.2, 10.0)
    contact = floor_contact([pressing, point(RIGHT, 0.9, 0.9, 0.0)])
    assert contact == floor_contact([pressing])


@pytest.mark.parametrize("points", [[], [point(LEFT, 0.1, 0.2, 0.0)]])
def test_without_load_the_zmp_is_held(points):
    contact = floor_contact(points)
    assert not contact.loaded
    assert contact.holding(HELD) == FloorContact(7.0, 8.0, 0.0, 0.0, 0.0)


def test_the_deepest_point_is_the_penetration():
    points = [point(LEFT, 0.0, 0.0, 1.0, d) for d in (-0.001, -0.004, 0.002)]
    assert floor_contact(points).penetration_m == 0.004


def test_a_point_above_the_floor_is_no_penetration():
    points = [point(LEFT, 0.0, 0.0, 0.0, 0.002)]
    assert floor_contact(points).penetration_m == 0.0
