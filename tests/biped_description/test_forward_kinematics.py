"""Feet, links and centre of mass, against Pinocchio's reading of the URDF."""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin
import pytest
from tests.robots import SHIPPED

from biped_description.errors import InvalidInputError
from biped_description.links import CONTACT_LINKS, LINK_NAMES
from biped_description.robot import Robot

ROWS = 200
FEET = list(enumerate(CONTACT_LINKS))


@dataclass
class Poses:
    """The same random poses of a robot, for it and for Pinocchio."""

    robot: Robot
    model: pin.Model
    waist: np.ndarray
    q: np.ndarray

    @property
    def configurations(self) -> np.ndarray:
        """(rows, 19) Pinocchio's, torso upright."""
        upright = np.tile([0.0, 0.0, 0.0, 1.0], (len(self.q), 1))
        return np.hstack([self.waist, upright, self.q])

    def placements(self, link: str) -> list[pin.SE3]:
        """Return the placement of a link's frame in the world for every row."""
        data, frame = self.model.createData(), self.model.getFrameId(link)
        placements = []
        for configuration in self.configurations:
            pin.framesForwardKinematics(self.model, data, configuration)
            placements.append(data.oMf[frame].copy())
        return placements


@pytest.fixture(scope="module")
def poses(robot, pin_model) -> Poses:
    rng = np.random.default_rng(20)
    limits = robot.position_lower_rad, robot.position_upper_rad
    q = rng.uniform(*limits, (ROWS, 12))
    return Poses(robot, pin_model, rng.normal(size=(ROWS, 3)), q)


@pytest.mark.parametrize(("index", "link"), FEET)
def test_the_sole_under_the_ankle_is_where_pinocchio_puts_it(poses, index, link):
    sole_below_ankle = np.array([0.0, 0.0, -poses.robot.settings.ankle_height_m])
    expected = [each.act(sole_below_ankle) for each in poses.placements(link)]
    foot = poses.robot.waist_to_feet(poses.q)[index]
    np.testing.assert_allclose(poses.waist + foot, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("index", "link"), FEET)
def test_the_feet_are_turned_as_pinocchio_turns_them(poses, index, link):
    expected = [placement.rotation for placement in poses.placements(link)]
    rotation = poses.robot.foot_poses(poses.q)[1][index]
    np.testing.assert_allclose(rotation, expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("index", range(len(LINK_NAMES)), ids=LINK_NAMES)
def test_the_com_of_a_link_is_where_pinocchio_puts_it(poses, index):
    placements = poses.placements(LINK_NAMES[index])
    # The torso rides on the free-flyer, and each leg link on the joint of its name.
    com_in_link = poses.model.inertias[index + 1].lever
    expected = [placement.act(com_in_link) for placement in placements]
    coms = poses.robot.link_com_positions(poses.waist, poses.q)[:, index]
    np.testing.assert_allclose(coms, expected, rtol=0, atol=1e-9)


def test_the_com_of_the_robot_is_where_pinocchio_puts_it(poses):
    data = poses.model.createData()
    expected = [
        pin.centerOfMass(poses.model, data, each).copy()
        for each in poses.configurations
    ]
    com = poses.robot.com_position(poses.waist, poses.q)
    np.testing.assert_allclose(com, expected, rtol=0, atol=1e-9)


def test_links_weigh_what_pinocchio_reads(robot, pin_model):
    masses = [inertia.mass for inertia in pin_model.inertias][1:]
    np.testing.assert_allclose(robot.link_masses_kg, masses, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    "function",
    [
        SHIPPED.waist_to_feet,
        lambda q: SHIPPED.com_position(np.zeros((20, 3)), q),
        lambda q: SHIPPED.link_com_positions(np.zeros((20, 3)), q),
    ],
    ids=["waist_to_feet", "com_position", "link_com_positions"],
)
def test_joint_positions_that_are_not_numbers_are_refused(function):
    q = np.zeros((20, 12))
    q[17, 4] = np.nan
    with pytest.raises(InvalidInputError, match="q at tick 17"):
        function(q)


def test_waist_and_joints_must_have_as_many_ticks():
    with pytest.raises(InvalidInputError, match="q has 3 ticks, waist 20"):
        SHIPPED.com_position(np.zeros((20, 3)), np.zeros((3, 12)))
