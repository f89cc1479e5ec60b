"""The URDF as it is generated and as PyBullet reads it."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from tests.robots import SHIPPED, TALL

from biped_description.joints import JOINT_NAMES
from biped_description.links import CONTACT_LINKS, LINK_NAMES

TORSO = -1  # PyBullet's number for the base link


@pytest.mark.parametrize(
    ("robot", "height_m"), [(SHIPPED, 1.10), (TALL, 1.69)], ids=["shipped", "tall"]
)
def test_the_crown_of_a_stretched_robot_is_above_the_floor_by_its_height(
    robot, height_m
):
    tops = []
    for visual in ET.fromstring(robot.urdf).iterfind("link[@name='torso']/visual"):
        z = float(visual.find("origin").get("xyz").split()[2])
        box = visual.find("geometry/box")
        if box is not None:
            tops.append(z + float(box.get("size").split()[2]) / 2)
    crown_m = max(tops) + robot.settings.stretched_leg_length_m
    assert crown_m == pytest.approx(height_m, abs=0.005)


def test_bullet_finds_the_joints_in_our_order(bullet_robot):
    names = [
        bullet_robot.joint_info(joint)[1].decode() for joint in bullet_robot.joints
    ]
    assert tuple(names) == JOINT_NAMES


def test_bullet_finds_our_links_on_the_joints(bullet_robot):
    links = [
        bullet_robot.joint_info(joint)[12].decode() for joint in bullet_robot.joints
    ]
    assert tuple(links) == LINK_NAMES[1:]


def test_bullet_finds_only_revolute_joints(bullet_robot):
    revolute = 0  # pybullet.JOINT_REVOLUTE
    assert {bullet_robot.joint_info(joint)[2] for joint in bullet_robot.joints} == {
        revolute
    }


@pytest.mark.parametrize(
    ("field", "expected"),
    [
        (8, lambda robot: robot.position_lower_rad),
        (9, lambda robot: robot.position_upper_rad),
        (10, lambda robot: robot.torque_limit_nm),
        (11, lambda robot: np.full(12, robot.settings.velocity_limit_rad_s)),
    ],
    ids=["lower", "upper", "torque", "velocity"],
)
def test_bullet_finds_our_limits(robot, bullet_robot, field, expected):
    found = [bullet_robot.joint_info(joint)[field] for joint in bullet_robot.joints]
    np.testing.assert_allclose(found, expected(robot), rtol=0, atol=1e-9)


def test_bullet_finds_our_masses(robot, bullet_robot):
    masses = [bullet_robot.mass(link) for link in (TORSO, *bullet_robot.joints)]
    np.testing.assert_allclose(masses, robot.link_masses_kg, rtol=0, atol=1e-12)


def test_only_the_contact_links_collide(bullet_robot):
    colliding = [
        bullet_robot.joint_info(link)[12].decode()
        for link in bullet_robot.joints
        if bullet_robot.collision_shapes(link)
    ]
    assert not bullet_robot.collision_shapes(TORSO)
    assert tuple(colliding) == CONTACT_LINKS


@pytest.mark.parametrize("foot", CONTACT_LINKS)
def test_the_sole_spans_its_box_about_the_point_under_the_ankle(foot):
    collision = ET.fromstring(SHIPPED.urdf).find(f"link[@name='{foot}']/collision")
    centre = np.array(collision.find("origin").get("xyz").split(), dtype=float)
    size = np.array(collision.find("geometry/box").get("size").split(), dtype=float)
    corners = [centre - size / 2, centre + size / 2]  # from the ankle
    expected = [[-0.09, -0.07, -0.06], [0.13, 0.07, -0.03]]
    np.testing.assert_allclose(corners, expected, rtol=0, atol=1e-12)
