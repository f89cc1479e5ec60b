"""Rotors of the joints' motors in a Bullet world, which knows no armature.

A rotor is a link of its own beside its joint, about the same axis, and a gear makes it
turn `_GEAR_RATIO` times as fast. Its inertia, seen from the joint, is that of the
setting; what it feels of its link's own turning is less by the ratio. So that is far
above a real one: with 100, a robot on one foot was seen to shake.
"""

from __future__ import annotations

import copy
import ctypes
import xml.etree.ElementTree as ET
from typing import Any, Final

from biped_description.joints import JOINT_NAMES
from sim_node.bullet_api import JOINT_GEAR, JointInfo, api

_GEAR_RATIO: Final = 10_000.0
_ROTOR_MASS_KG: Final = 1e-6
"""Next to nothing: the robot's table has the masses."""
# More than there ever is, of what the API bounds by default.
_FORCE_OF_GEARS_NM: Final = 1e12
_FASTEST_JOINT_RAD_S: Final = 1e12


def _rotor_of(joint: str) -> str:
    """Return the name of a joint's rotor."""
    return f"{joint}_rotor"


def with_rotors(urdf: str, inertia_kg_m2: float) -> str:
    """Return a URDF with a rotor to every joint; inertia as seen from the joint."""
    root = ET.fromstring(urdf)
    own = f"{inertia_kg_m2 / _GEAR_RATIO**2:.17g}"
    for name in JOINT_NAMES:
        joint = root.find(f"joint[@name='{name}']")
        assert joint is not None
        rotor = ET.SubElement(root, "link", name=_rotor_of(name))
        inertial = ET.SubElement(rotor, "inertial")
        ET.SubElement(inertial, "mass", value=f"{_ROTOR_MASS_KG}")
        tensor = dict.fromkeys(("ixx", "iyy", "izz"), own)
        tensor |= dict.fromkeys(("ixy", "ixz", "iyz"), "0")
        ET.SubElement(inertial, "inertia", tensor)
        bearing = ET.SubElement(root, "joint", name=_rotor_of(name), type="continuous")
        for part in ("parent", "origin", "axis"):
            bearing.extend(copy.deepcopy(joint.findall(part)))
        ET.SubElement(bearing, "child", link=_rotor_of(name))
    return ET.tostring(root, encoding="unicode")


def gear_rotors(client: int, robot: int, numbers: dict[str, int]) -> None:
    """Let the rotors turn with their joints.

    Args:
        client: of the world.
        robot: its body.
        numbers: of joints and rotors in the API, by name.

    Raises:
        RuntimeError: Bullet makes no gear.
    """
    unbounded = api.b3InitChangeDynamicsInfo(client)
    api.b3ChangeDynamicsInfoSetMaxJointVelocity(unbounded, robot, _FASTEST_JOINT_RAD_S)
    _submit(client, unbounded)
    for name in JOINT_NAMES:
        gear = JointInfo(joint_type=JOINT_GEAR)
        gear.axis[:] = (1.0, 0.0, 0.0)  # not used between joints
        gear.parent_frame[:] = gear.child_frame[:] = (0.0,) * 6 + (1.0,)
        ends = robot, numbers[name], robot, numbers[_rotor_of(name)]
        command = api.b3InitCreateUserConstraintCommand(
            client, *ends, ctypes.addressof(gear)
        )
        made = api.b3GetStatusUserConstraintUniqueId(_submit(client, command))
        if made < 0:
            raise RuntimeError(f"{name}: Bullet makes no gear to its rotor")
        command = api.b3InitChangeUserConstraintCommand(client, made)
        api.b3InitChangeUserConstraintSetGearRatio(command, 1.0 / _GEAR_RATIO)
        api.b3InitChangeUserConstraintSetMaxForce(command, _FORCE_OF_GEARS_NM)
        # Velocities are geared, positions are not: nobody asks where a rotor stands.
        api.b3InitChangeUserConstraintSetERP(command, 0.0)
        _submit(client, command)


def _submit(client: int, command: int) -> Any:
    return api.b3SubmitClientCommandAndWaitStatus(client, command)
