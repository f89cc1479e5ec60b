"""The table that makes a robot: dimensions, masses and limits of joints.

Every body frame is parallel to the world frame (x forward, y left, z up) when the robot
stands straight. The defaults are the shipped robot, 1.10 m tall and 28.87 kg.

Choices that the walk hardly feels, made for simplicity: the moments of inertia of
thigh and shank are those of solid cylinders centred on the limb's CoM, although that
lies above half length; the foot is its sole, a uniform plate, with the CoM in its
middle; the torso is a uniform box.
"""

import math
from dataclasses import dataclass
from typing import Any

from biped_common.settings import Settings, SettingsError, setting
from biped_description.joints import JOINTS_PER_LEG, KNEE, LEG_JOINTS
from biped_description.shapes import Box, Cylinder

_LENGTHS_M = (0.001, 2.0)
_MASSES_KG = (0.001, 200.0)
_POSITIONS_RAD = (-3.0, 3.0)  # a leg must not fold to nothing


def _length(default: float, doc: str) -> Any:
    return setting(default, "m", doc, lower=_LENGTHS_M[0], upper=_LENGTHS_M[1])


def _mass(default: float, doc: str) -> Any:
    return setting(default, "kg", doc, lower=_MASSES_KG[0], upper=_MASSES_KG[1])


@dataclass(frozen=True)
class RobotSettings(Settings):
    """A torso on two mirrored legs of six joints each.

    The three hip axes meet in one point, and so do the two ankle axes.
    """

    # Leg, from the hip down.
    half_hip_spacing_m: float = _length(0.09, "waist to either hip, along y")
    thigh_length_m: float = _length(0.24, "hip to knee")
    shank_length_m: float = _length(0.24, "knee to ankle")
    ankle_height_m: float = _length(0.06, "ankle to sole plane")
    thigh_radius_m: float = _length(0.045, "of a cylinder as long as the thigh")
    shank_radius_m: float = _length(0.035, "of a cylinder as long as the shank")
    limb_com_fraction: float = setting(
        0.45,
        "",
        "CoM of thigh and shank, share of their length from the top",
        lower=0.0,
        upper=1.0,
    )
    sole_length_m: float = _length(0.22, "along x")
    sole_width_m: float = _length(0.14, "along y")
    sole_thickness_m: float = _length(0.03, "up from the sole plane")
    sole_ahead_of_ankle_m: float = setting(
        0.02, "m", "ankle to centre of the sole, along x", lower=-0.5, upper=0.5
    )

    # Torso, a box.
    torso_depth_m: float = _length(0.16, "along x")
    torso_width_m: float = _length(0.24, "along y")
    torso_height_m: float = _length(0.50, "along z, centred on the torso's CoM")
    torso_com_height_m: float = _length(0.20, "waist to the torso's CoM")

    # Masses; those of the leg count once per leg.
    torso_mass_kg: float = _mass(18.47, "with everything above the hips")
    hip_yaw_mass_kg: float = _mass(0.2, "between hip yaw and hip roll")
    hip_roll_mass_kg: float = _mass(0.2, "between hip roll and hip pitch")
    thigh_mass_kg: float = _mass(2.5, "hip to knee")
    shank_mass_kg: float = _mass(1.4, "knee to ankle")
    ankle_mass_kg: float = _mass(0.2, "between ankle pitch and ankle roll")
    foot_mass_kg: float = _mass(0.7, "a plate of the sole's size")
    joint_housing_inertia_kg_m2: float = setting(
        4e-4,
        "kg m^2",
        "of hip yaw, hip roll and ankle links, about each axis",
        above=0.0,
        upper=1.0,
    )

    # Joints of a leg from the hip yaw down, as in `joints.LEG_JOINTS`.
    position_lower_rad: tuple[float, ...] = setting(
        (-0.8, -0.6, -1.6, 0.0, -1.2, -0.6),
        "rad",
        "lower position limits of a leg's joints, from the hip yaw down",
        lower=_POSITIONS_RAD[0],
        upper=_POSITIONS_RAD[1],
    )
    position_upper_rad: tuple[float, ...] = setting(
        (0.8, 0.6, 0.8, 2.2, 1.2, 0.6),
        "rad",
        "upper position limits of a leg's joints, from the hip yaw down",
        lower=_POSITIONS_RAD[0],
        upper=_POSITIONS_RAD[1],
    )
    torque_limit_nm: tuple[float, ...] = setting(
        (40.0, 80.0, 80.0, 100.0, 80.0, 60.0),
        "N m",
        "torque limits of a leg's joints, from the hip yaw down",
        above=0.0,
        upper=10_000.0,
    )
    velocity_limit_rad_s: float = setting(
        20.0 * math.pi,
        "rad/s",
        "speed of any joint at which a walk ends (Table 1)",
        above=0.0,
    )

    def check_together(self) -> None:
        """Refuse values that are at odds with one another."""
        for name in ("position_lower_rad", "position_upper_rad", "torque_limit_nm"):
            values = getattr(self, name)
            if len(values) != JOINTS_PER_LEG:
                joints = ", ".join(joint.name for joint in LEG_JOINTS)
                raise SettingsError(
                    name, values, f"must be {JOINTS_PER_LEG} numbers: {joints}"
                )
        for joint, lower, upper in zip(
            LEG_JOINTS, self.position_lower_rad, self.position_upper_rad, strict=True
        ):
            if lower >= upper:
                raise SettingsError(
                    "position_upper_rad",
                    self.position_upper_rad,
                    f"{joint.name} must be above its lower limit of {lower} rad",
                )
        if self.position_lower_rad[KNEE] < 0.0:
            raise SettingsError(
                "position_lower_rad",
                self.position_lower_rad,
                "knee must be at least 0.0 rad, since knees do not bend forward",
            )
        if self.sole_thickness_m > self.ankle_height_m:
            raise SettingsError(
                "sole_thickness_m",
                self.sole_thickness_m,
                f"must be at most ankle_height_m = {self.ankle_height_m} m",
            )

    # -- what follows --------------------------------------------------------------

    @property
    def torso(self) -> Box:
        """Body of the torso."""
        return Box(self.torso_depth_m, self.torso_width_m, self.torso_height_m)

    @property
    def thigh(self) -> Cylinder:
        """Body of a thigh."""
        return Cylinder(self.thigh_radius_m, self.thigh_length_m)

    @property
    def shank(self) -> Cylinder:
        """Body of a shank."""
        return Cylinder(self.shank_radius_m, self.shank_length_m)

    @property
    def sole(self) -> Box:
        """Body of a foot, its bottom on the sole plane: all that collides."""
        return Box(self.sole_length_m, self.sole_width_m, self.sole_thickness_m)

    @property
    def stretched_leg_length_m(self) -> float:
        """Height of the hip line above the floor with straight knees."""
        return self.thigh_length_m + self.shank_length_m + self.ankle_height_m

    @property
    def thigh_com_below_hip_m(self) -> float:
        """Distance from hip to the CoM of the thigh."""
        return self.limb_com_fraction * self.thigh_length_m

    @property
    def shank_com_below_knee_m(self) -> float:
        """Distance from knee to the CoM of the shank."""
        return self.limb_com_fraction * self.shank_length_m

    @property
    def foot_com_below_ankle_m(self) -> float:
        """Distance along z from ankle to the CoM of the foot, its sole's centre."""
        return self.ankle_height_m - self.sole_thickness_m / 2
