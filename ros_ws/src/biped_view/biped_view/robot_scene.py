"""The robot in a viser scene: the shapes of its URDF on a chain of frames.

A frame stands in its parent's, so that moving the robot means turning twelve frames by
their joints and placing the torso: whoever draws the scene does the rest.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray

from biped_common.errors import BipedError
from biped_description.joints import JOINT_NAMES
from biped_description.links import TORSO

Array = NDArray[np.float64]
_NAME = "/robot"
"""Of the torso's frame in the scene's tree."""


class BadUrdfError(BipedError, ValueError):
    """The text is no URDF of a robot with the joints that are known here."""


class RobotScene:
    """A robot that can be moved, under one name of the scene's tree."""

    def __init__(self, scene: viser.SceneApi, urdf: str) -> None:
        """Add the robot to the scene, joints at zero, torso at the origin.

        Args:
            scene: of a viser server.
            urdf: of a robot such as `Robot.urdf` describes.

        Raises:
            BadUrdfError: it is no URDF of a robot with our joints.
        """
        try:
            self._add(scene, ET.fromstring(urdf))
        except (ET.ParseError, AssertionError, LookupError, ValueError) as error:
            raise BadUrdfError(f"URDF of another robot, or none: {error}") from None

    def _add(self, scene: viser.SceneApi, urdf: ET.Element) -> None:
        colours = {
            material.attrib["name"]: _numbers(material.find("color"), "rgba")
            for material in urdf.iterfind("material")
        }
        links = {link.attrib["name"]: link for link in urdf.iterfind("link")}
        self._torso = scene.add_frame(_NAME, show_axes=False)
        _add_shapes(scene, _NAME, links[TORSO], colours)
        paths = {TORSO: _NAME}
        joints: dict[str, tuple[viser.FrameHandle, Array]] = {}
        for joint in urdf.iterfind("joint"):  # from the torso down
            parent, child = _name(joint, "parent"), _name(joint, "child")
            paths[child] = f"{paths[parent]}/{child}"
            frame = scene.add_frame(
                paths[child],
                show_axes=False,
                position=_numbers(joint.find("origin"), "xyz"),
            )
            joints[joint.attrib["name"]] = frame, _numbers(joint.find("axis"), "xyz")
            _add_shapes(scene, paths[child], links[child], colours)
        self._frames = [joints[each][0] for each in JOINT_NAMES]
        self._axes = np.array([joints[each][1] for each in JOINT_NAMES])
        self._angles_rad = np.zeros(len(JOINT_NAMES))

    def move(
        self,
        torso_position_m: ArrayLike,
        torso_quaternion_wxyz: ArrayLike,
        joint_position_rad: ArrayLike,
    ) -> None:
        """Place the robot.

        Args:
            torso_position_m: (3,) origin of the torso link in the world frame.
            torso_quaternion_wxyz: (4,) its orientation, of length 1.
            joint_position_rad: (12,) in the order of `JOINT_NAMES`.
        """
        self._torso.position = np.asarray(torso_position_m, dtype=np.float64)
        self._torso.wxyz = np.asarray(torso_quaternion_wxyz, dtype=np.float64)
        angles = np.array(joint_position_rad, dtype=np.float64)
        half = angles[:, None] / 2
        turns = np.hstack((np.cos(half), np.sin(half) * self._axes))
        for joint in np.flatnonzero(angles != self._angles_rad):
            self._frames[joint].wxyz = turns[joint]
        self._angles_rad = angles


def _add_shapes(
    scene: viser.SceneApi, path: str, link: ET.Element, colours: dict[str, Array]
) -> None:
    """Add the shapes of a link that are there to be seen."""
    for number, visual in enumerate(link.iterfind("visual")):
        name = f"{path}/shape_{number}"
        centre = _numbers(visual.find("origin"), "xyz")
        red, green, blue, _ = np.round(255 * colours[_name(visual, "material", "name")])
        colour = int(red), int(green), int(blue)
        geometry = visual.find("geometry")
        assert geometry is not None
        (shape,) = geometry
        if shape.tag == "box":
            length_x, length_y, length_z = _numbers(shape, "size")
            scene.add_box(name, colour, (length_x, length_y, length_z), position=centre)
        elif shape.tag == "cylinder":
            scene.add_cylinder(
                name,
                float(shape.attrib["radius"]),
                float(shape.attrib["length"]),
                colour,
                position=centre,
            )
        else:
            radius = float(shape.attrib["radius"])
            scene.add_icosphere(name, radius, colour, position=centre)


def _name(element: ET.Element, tag: str, attribute: str = "link") -> str:
    child = element.find(tag)
    assert child is not None
    return child.attrib[attribute]


def _numbers(element: ET.Element | None, attribute: str) -> Array:
    assert element is not None
    return np.array([float(word) for word in element.attrib[attribute].split()])
