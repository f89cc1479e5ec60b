"""ZMP and loads from contact points."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim_node.contact import FloorContact
from sim_node.pybullet_world import floor_contact

LEFT, RIGHT = 5, 11
HELD = FloorContact(7.0, 8.0, 100.0, 100.0, 0.001)


def point(link, x, y, force, distance=0.0):
    """Return a contact point as PyBullet lays it out."""
    above, below, up = (x, y, distance), (x, y, 0.0), (0.0, 0.0, 1.0)
    return (0, 1, 0, link, -1, above, below, up, distance, force, 0, (), 0, ())


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
        [point(LEFT, 0.0, 0.1, 30.0), point(RIGHT, 0.4, -0.1, 10.0)], LEFT, HELD
    )
    assert contact[:2] == pytest.approx((0.1, 0.05))


@settings(deadline=None, max_examples=50)
@given(st.lists(points, min_size=1, max_size=8))
def test_the_zmp_is_among_the_points(points):
    zmp_x = floor_contact(points, LEFT, HELD).zmp_x_m
    xs = [each[6][0] for each in points]
    assert min(xs) - 1e-12 <= zmp_x <= max(xs) + 1e-12


@settings(deadline=None, max_examples=50)
@given(st.lists(points, max_size=8))
def test_each_foot_carries_its_own_points(points):
    contact = floor_contact(points, LEFT, HELD)
    left, right = (
        sum(each[9] for each in points if each[3] == link) for link in (LEFT, RIGHT)
    )
    assert contact[2:4] == (pytest.approx(left), pytest.approx(right))


def test_a_point_without_force_does_not_count():
    pressing = point(LEFT, 0.1, 0.2, 10.0)
    contact = floor_contact([pressing, point(RIGHT, 0.9, 0.9, 0.0)], LEFT, HELD)
    assert contact == floor_contact([pressing], LEFT, HELD)


@pytest.mark.parametrize("points", [[], [point(LEFT, 0.1, 0.2, 0.0)]])
def test_without_load_the_zmp_is_held(points):
    assert floor_contact(points, LEFT, HELD) == FloorContact(7.0, 8.0, 0.0, 0.0, 0.0)


def test_the_deepest_point_is_the_penetration():
    points = [point(LEFT, 0.0, 0.0, 1.0, d) for d in (-0.001, -0.004, 0.002)]
    assert floor_contact(points, LEFT, HELD).penetration_m == 0.004


def test_a_point_above_the_floor_is_no_penetration():
    points = [point(LEFT, 0.0, 0.0, 0.0, 0.002)]
    assert floor_contact(points, LEFT, HELD).penetration_m == 0.0
