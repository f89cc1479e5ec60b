"""The committed URDF, as generated and as PyBullet reads it."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from biped_description import urdf
from biped_description.dimensions import BIPED
from biped_description.joints import (
    JOINT_NAMES,
    POSITION_LOWER,
    POSITION_UPPER,
    TORQUE_LIMIT,
    VELOCITY_LIMIT,
)
from biped_description.links import LINK_MASSES, LINK_NAMES

TORSO = -1  # PyBullet's number for the base link


def test_the_committed_file_is_what_the_tables_generate():
    assert urdf.urdf_path().read_text(encoding="utf-8") == urdf.urdf_text()


def test_writing_replaces_the_file_and_leaves_nothing_else(tmp_path):
    path = tmp_path / "biped.urdf"
    path.write_text("stale")
    urdf.write_urdf(path)
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == {
        "biped.urdf": urdf.urdf_text()
    }


def test_without_write_the_text_is_printed(capsys):
    urdf.main([])
    assert capsys.readouterr().out == urdf.urdf_text()


def test_with_write_the_committed_file_is_rewritten(tmp_path, monkeypatch):
    path = tmp_path / "biped.urdf"
    monkeypatch.setattr(urdf, "urdf_path", lambda: path)
    urdf.main(["--write"])
    assert path.read_text() == urdf.urdf_text()


def test_the_crown_of_a_stretched_robot_is_1_10_m_above_the_floor():
    tops = []
    for visual in ET.fromstring(urdf.urdf_text()).iterfind(
        "link[@name='torso']/visual"
    ):
        z = float(visual.find("origin").get("xyz").split()[2])
        box = visual.find("geometry/box")
        if box is not None:
            tops.append(z + float(box.get("size").split()[2]) / 2)
    assert max(tops) + BIPED.stretched_leg_length == pytest.approx(1.10, abs=1e-9)


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
        (8, POSITION_LOWER),
        (9, POSITION_UPPER),
        (10, TORQUE_LIMIT),
        (11, np.full(12, VELOCITY_LIMIT)),
    ],
    ids=["lower", "upper", "torque", "velocity"],
)
def test_bullet_finds_our_limits(bullet_robot, field, expected):
    found = [bullet_robot.joint_info(joint)[field] for joint in bullet_robot.joints]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)


def test_bullet_finds_our_masses(bullet_robot):
    masses = [bullet_robot.mass(link) for link in (TORSO, *bullet_robot.joints)]
    np.testing.assert_allclose(masses, LINK_MASSES, rtol=0, atol=1e-12)


def test_only_the_soles_collide(bullet_robot):
    colliding = [
        link
        for link in (TORSO, *bullet_robot.joints)
        if bullet_robot.collision_shapes(link)
    ]
    feet = [JOINT_NAMES.index("left_ankle_roll"), JOINT_NAMES.index("right_ankle_roll")]
    assert colliding == feet


@pytest.mark.parametrize("foot", ["left_foot", "right_foot"])
def test_the_sole_spans_its_box_about_the_point_under_the_ankle(foot):
    collision = ET.fromstring(urdf.urdf_text()).find(f"link[@name='{foot}']/collision")
    centre = np.array(collision.find("origin").get("xyz").split(), dtype=float)
    size = np.array(collision.find("geometry/box").get("size").split(), dtype=float)
    corners = [centre - size / 2, centre + size / 2]  # from the ankle
    expected = [[-0.09, -0.07, -0.06], [0.13, 0.07, -0.03]]
    np.testing.assert_allclose(corners, expected, rtol=0, atol=1e-12)
