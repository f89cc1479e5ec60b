"""The thirteen links: names, masses, mass centres and inertias.

A link's frame has its origin at the joint that moves the link; the torso's is at the
waist. Order: torso, left leg from the hip down, right leg from the hip down.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from biped_description.dimensions import BIPED, Biped
from biped_description.joints import LEGS


class Link(NamedTuple):
    """Mass properties of one link, in its own frame."""

    name: str
    mass: float  # [kg]
    com: tuple[float, float, float]  # [m]
    inertia: tuple[float, float, float]  # ixx, iyy, izz about the CoM [kg m^2]


def torso_link(biped: Biped = BIPED) -> Link:
    """Return the torso, the base of both legs."""
    com = (0.0, 0.0, biped.torso_com_height)
    return Link("torso", biped.torso_mass, com, biped.torso.inertia(biped.torso_mass))


def leg_links(leg: str, biped: Biped = BIPED) -> tuple[Link, ...]:
    """Return the six links of ``leg`` ("left" or "right"), each moved by its joint."""
    at_joint = (0.0, 0.0, 0.0)
    housing = (biped.joint_housing_inertia,) * 3
    thigh_com = (0.0, 0.0, -biped.thigh_com_below_hip)
    shank_com = (0.0, 0.0, -biped.shank_com_below_knee)
    foot_com = (biped.sole_ahead_of_ankle, 0.0, -biped.foot_com_below_ankle)
    thigh_inertia = biped.thigh.inertia(biped.thigh_mass)
    shank_inertia = biped.shank.inertia(biped.shank_mass)
    foot_inertia = biped.sole.inertia(biped.foot_mass)
    return (
        Link(f"{leg}_hip_yaw_link", biped.hip_yaw_mass, at_joint, housing),
        Link(f"{leg}_hip_roll_link", biped.hip_roll_mass, at_joint, housing),
        Link(f"{leg}_thigh", biped.thigh_mass, thigh_com, thigh_inertia),
        Link(f"{leg}_shank", biped.shank_mass, shank_com, shank_inertia),
        Link(f"{leg}_ankle", biped.ankle_mass, at_joint, housing),
        Link(f"{leg}_foot", biped.foot_mass, foot_com, foot_inertia),
    )


LINKS: Final = (torso_link(), *leg_links(LEGS[0]), *leg_links(LEGS[1]))
LINK_NAMES: Final = tuple(link.name for link in LINKS)

# (13,) masses in the order of LINK_NAMES [kg].
LINK_MASSES: Final[NDArray[np.float64]] = np.array([link.mass for link in LINKS])
LINK_MASSES.flags.writeable = False
