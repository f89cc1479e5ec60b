"""Feet, links and centre of mass, against Pinocchio's reading of the URDF."""

import numpy as np
import pinocchio as pin
import pytest

from biped_description.dimensions import BIPED
from biped_description.errors import InvalidInputError
from biped_description.joints import POSITION_LOWER, POSITION_UPPER
from biped_description.kinematics import (
    LINK_MASSES,
    LINK_NAMES,
    com_position,
    foot_orientations,
    link_com_positions,
    waist_to_feet,
)

RANDOM = np.random.default_rng(20)
Q = RANDOM.uniform(POSITION_LOWER, POSITION_UPPER, (200, 12))
WAIST = RANDOM.normal(size=(200, 3))
SOLE_BELOW_ANKLE = np.array([0.0, 0.0, -BIPED.ankle_height])


def configurations():
    """Yield Pinocchio's configuration, torso upright, for every row of Q."""
    for waist, q in zip(WAIST, Q, strict=True):
        yield np.concatenate([waist, [0.0, 0.0, 0.0, 1.0], q])


def link_placements(model: pin.Model, link: str) -> list[pin.SE3]:
    """Return the placement of a link's frame in the world for every row of Q."""
    data, frame = model.createData(), model.getFrameId(link)
    placements = []
    for configuration in configurations():
        pin.framesForwardKinematics(model, data, configuration)
        placements.append(data.oMf[frame].copy())
    return placements


@pytest.mark.parametrize(("index", "link"), [(0, "left_foot"), (1, "right_foot")])
def test_the_sole_under_the_ankle_is_where_pinocchio_puts_it(pin_model, index, link):
    placements = link_placements(pin_model, link)
    expected = [placement.act(SOLE_BELOW_ANKLE) for placement in placements]
    foot = waist_to_feet(Q)[index]
    np.testing.assert_allclose(WAIST + foot, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("index", "link"), [(0, "left_foot"), (1, "right_foot")])
def test_the_feet_are_turned_as_pinocchio_turns_them(pin_model, index, link):
    expected = [placement.rotation for placement in link_placements(pin_model, link)]
    rotation = foot_orientations(Q)[index]
    np.testing.assert_allclose(rotation, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("index", range(len(LINK_NAMES)), ids=LINK_NAMES)
def test_the_com_of_a_link_is_where_pinocchio_puts_it(pin_model, index):
    placements = link_placements(pin_model, LINK_NAMES[index])
    # The torso rides on the free-flyer, and each leg link on the joint of its name.
    com_in_link = pin_model.inertias[index + 1].lever
    expected = [placement.act(com_in_link) for placement in placements]
    coms = link_com_positions(WAIST, Q)[:, index]
    np.testing.assert_allclose(coms, expected, rtol=0, atol=1e-9)


def test_the_com_of_the_robot_is_where_pinocchio_puts_it(pin_model):
    data = pin_model.createData()
    expected = [pin.centerOfMass(pin_model, data, c).copy() for c in configurations()]
    np.testing.assert_allclose(com_position(WAIST, Q), expected, rtol=0, atol=1e-9)


def test_links_weigh_what_pinocchio_reads(pin_model):
    masses = [inertia.mass for inertia in pin_model.inertias][1:]
    np.testing.assert_allclose(LINK_MASSES, masses, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "function",
    [
        waist_to_feet,
        foot_orientations,
        lambda q: com_position(WAIST, q),
        lambda q: link_com_positions(WAIST, q),
    ],
    ids=["waist_to_feet", "foot_orientations", "com_position", "link_com_positions"],
)
def test_joint_positions_that_are_not_numbers_are_refused(function):
    q = Q.copy()
    q[17, 4] = np.nan
    with pytest.raises(InvalidInputError, match="q at tick 17"):
        function(q)


def test_waist_and_joints_must_have_as_many_ticks():
    with pytest.raises(InvalidInputError, match="q has 3 ticks, waist 200"):
        com_position(WAIST, Q[:3])
