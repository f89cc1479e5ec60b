"""The thirteen links: names, masses, mass centres and inertias.

A link's frame has its origin at the joint that moves the link; the torso's is at the
waist. Order: torso, left leg from the hip down, right leg from the hip down.
"""

from typing import Final, NamedTuple

from biped_description.joints import LEGS
from biped_description.settings import RobotSettings

TORSO: Final = "torso"
LEG_LINKS: Final = ("hip_yaw_link", "hip_roll_link", "thigh", "shank", "ankle", "foot")
"""Links of a leg, each moved by the joint of the same place in `joints.LEG_JOINTS`."""

LINK_NAMES: Final = (TORSO, *(f"{leg}_{name}" for leg in LEGS for name in LEG_LINKS))
CONTACT_LINKS: Final = tuple(f"{leg}_foot" for leg in LEGS)
"""The soles, left and right: all that can touch the floor."""


class Link(NamedTuple):
    """Mass properties of one link, in its own frame."""

    name: str
    mass: float  # [kg]
    com: tuple[float, float, float]  # [m]
    inertia: tuple[float, float, float]  # ixx, iyy, izz about the CoM [kg m^2]


def torso_link(robot: RobotSettings) -> Link:
    """Return the torso, the base of both legs."""
    com = (0.0, 0.0, robot.torso_com_height_m)
    return Link(
        TORSO, robot.torso_mass_kg, com, robot.torso.inertia(robot.torso_mass_kg)
    )


def leg_links(leg: str, robot: RobotSettings) -> tuple[Link, ...]:
    """Return the six links of ``leg`` ("left" or "right"), each moved by its joint."""
    at_joint = (0.0, 0.0, 0.0)
    housing = (robot.joint_housing_inertia_kg_m2,) * 3
    thigh_com = (0.0, 0.0, -robot.thigh_com_below_hip_m)
    shank_com = (0.0, 0.0, -robot.shank_com_below_knee_m)
    foot_com = (robot.sole_ahead_of_ankle_m, 0.0, -robot.foot_com_below_ankle_m)
    properties = (
        (robot.hip_yaw_mass_kg, at_joint, housing),
        (robot.hip_roll_mass_kg, at_joint, housing),
        (robot.thigh_mass_kg, thigh_com, robot.thigh.inertia(robot.thigh_mass_kg)),
        (robot.shank_mass_kg, shank_com, robot.shank.inertia(robot.shank_mass_kg)),
        (robot.ankle_mass_kg, at_joint, housing),
        (robot.foot_mass_kg, foot_com, robot.sole.inertia(robot.foot_mass_kg)),
    )
    return tuple(
        Link(f"{leg}_{name}", *each)
        for name, each in zip(LEG_LINKS, properties, strict=True)
    )


def all_links(robot: RobotSettings) -> tuple[Link, ...]:
    """Return all links, in the order of LINK_NAMES."""
    return (
        torso_link(robot),
        *(each for leg in LEGS for each in leg_links(leg, robot)),
    )
