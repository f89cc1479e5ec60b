"""Rotors of the joints' motors in a Bullet world, which knows no armature.

A rotor is a link of its own beside its joint, about the same axis, and a gear makes it
turn `GEAR_RATIO` times as fast. Its inertia, seen from the joint, is that of the
setting; what it feels of its link's own turning is less by the ratio. With a ratio of
100 that is enough for a robot on one foot to shake; with 1,000 and 10,000 it walks, its
ZMPs 0.3 mm apart at the peak.
"""

from __future__ import annotations

import copy
import ctypes
import xml.etree.ElementTree as ET
from typing import Any, Final

from biped_description.joints import JOINT_NAMES
from sim_node.bullet_api import JOINT_GEAR, api

GEAR_RATIO: Final = 10000.0
_ROTOR_MASS_KG: Final = 1e-6
_NO_END: Final = 1e12
"""For what the API bounds: forces of gears [N m], velocities of joints [rad/s]."""


class JointInfo(ctypes.Structure):
    """The API's b3JointInfo."""

    _fields_ = (
        ("link_name", ctypes.c_char * 1024),
        ("joint_name", ctypes.c_char * 1024),
        ("joint_type", ctypes.c_int),
        ("q_index", ctypes.c_int),
        ("u_index", ctypes.c_int),
        ("number", ctypes.c_int),
        ("flags", ctypes.c_int),
        ("damping", ctypes.c_double),
        ("friction", ctypes.c_double),
        ("lower_limit", ctypes.c_double),
        ("upper_limit", ctypes.c_double),
        ("max_force", ctypes.c_double),
        ("max_velocity", ctypes.c_double),
        ("parent_frame", ctypes.c_double * 7),
        ("child_frame", ctypes.c_double * 7),
        ("axis", ctypes.c_double * 3),
        ("parent", ctypes.c_int),
        ("q_size", ctypes.c_int),
        ("u_size", ctypes.c_int),
    )


def rotor_of(joint: str) -> str:
    """Return the name of a joint's rotor."""
    return f"{joint}_rotor"


def with_rotors(urdf: str, inertia_kg_m2: float) -> str:
    """Return a URDF with a rotor to every joint; inertia as seen from the joint."""
    root = ET.fromstring(urdf)
    own = f"{inertia_kg_m2 / GEAR_RATIO**2:.17g}"
    for name in JOINT_NAMES:
        joint = root.find(f"joint[@name='{name}']")
        assert joint is not None
        rotor = ET.SubElement(root, "link", name=rotor_of(name))
        inertial = ET.SubElement(rotor, "inertial")
        ET.SubElement(inertial, "mass", value=f"{_ROTOR_MASS_KG}")
        tensor = dict.fromkeys(("ixx", "iyy", "izz"), own)
        tensor |= dict.fromkeys(("ixy", "ixz", "iyz"), "0")
        ET.SubElement(inertial, "inertia", tensor)
        bearing = ET.SubElement(root, "joint", name=rotor_of(name), type="continuous")
        for part in ("parent", "origin", "axis"):
            bearing.extend(copy.deepcopy(joint.findall(part)))
        ET.SubElement(bearing, "child", link=rotor_of(name))
    return ET.tostring(root, encoding="unicode")


def gear_rotors(client: int, robot: int, numbers: dict[str, int]) -> None:
    """Let the rotors turn with their joints.

    Args:
        client: of the world.
        robot: its body.
        numbers: of joints and rotors in the API, by name.
    """
    unbounded = api.b3InitChangeDynamicsInfo(client)
    api.b3ChangeDynamicsInfoSetMaxJointVelocity(unbounded, robot, _NO_END)
    _submit(client, unbounded)
    for name in JOINT_NAMES:
        gear = JointInfo(joint_type=JOINT_GEAR)
        gear.axis[:] = (1.0, 0.0, 0.0)  # not used between joints
        gear.parent_frame[:] = gear.child_frame[:] = (0.0,) * 6 + (1.0,)
        ends = robot, numbers[name], robot, numbers[rotor_of(name)]
        command = api.b3InitCreateUserConstraintCommand(
            client, *ends, ctypes.addressof(gear)
        )
        made = api.b3GetStatusUserConstraintUniqueId(_submit(client, command))
        command = api.b3InitChangeUserConstraintCommand(client, made)
        api.b3InitChangeUserConstraintSetGearRatio(command, 1.0 / GEAR_RATIO)
        api.b3InitChangeUserConstraintSetMaxForce(command, _NO_END)
        api.b3InitChangeUserConstraintSetERP(command, 0.0)
        _submit(client, command)


def _submit(client: int, command: int) -> Any:
    return api.b3SubmitClientCommandAndWaitStatus(client, command)
