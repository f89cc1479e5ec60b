"""Dimensions and masses of the biped: 1.10 m tall, 28.87 kg.

Lengths are in metres, masses in kilograms, inertias in kg m^2. Every body frame is
parallel to the world frame (x forward, y left, z up) when the robot stands straight.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Box:
    """Solid box of uniform density, edges along the axes of its link."""

    length_x: float  # [m]
    length_y: float  # [m]
    length_z: float  # [m]

    def inertia(self, mass: float) -> tuple[float, float, float]:
        """Return the principal moments (ixx, iyy, izz) about the centre [kg m^2]."""
        xx, yy, zz = self.length_x**2, self.length_y**2, self.length_z**2
        return mass * (yy + zz) / 12, mass * (xx + zz) / 12, mass * (xx + yy) / 12


@dataclass(frozen=True, slots=True)
class Cylinder:
    """Solid cylinder of uniform density, axis along z."""

    radius: float  # [m]
    length_z: float  # [m]

    def inertia(self, mass: float) -> tuple[float, float, float]:
        """Return the principal moments (ixx, iyy, izz) about the centre [kg m^2]."""
        across = mass * (3 * self.radius**2 + self.length_z**2) / 12
        return across, across, mass * self.radius**2 / 2


@dataclass(frozen=True, slots=True)
class Biped:
    """A torso on two mirrored legs of six joints each.

    The three hip axes meet in one point, and so do the two ankle axes.
    """

    # Stature
    height: float  # floor to crown, legs stretched [m]
    waist_height: float  # floor to hip line in the walking posture [m]

    # Leg, from the hip down
    half_hip_spacing: float  # waist to either hip, along y [m]
    thigh_length: float  # hip to knee [m]
    shank_length: float  # knee to ankle [m]
    ankle_height: float  # ankle to sole plane [m]
    limb_com_fraction: float  # CoM of thigh and shank, share of length from the top []

    # Bodies that carry the mass of their link, of uniform density
    torso: Box  # centred on the torso's CoM
    torso_com_height: float  # waist to torso CoM [m]
    thigh: Cylinder
    shank: Cylinder
    sole: Box  # bottom on the sole plane; also the only shape that collides
    sole_ahead_of_ankle: float  # ankle to centre of the sole, along x [m]
    joint_housing_inertia: float  # hip yaw, hip roll, ankle links, each axis [kg m^2]

    # Masses [kg]; those of the leg count once per leg
    torso_mass: float
    hip_yaw_mass: float
    hip_roll_mass: float
    thigh_mass: float
    shank_mass: float
    ankle_mass: float
    foot_mass: float

    @property
    def leg_mass(self) -> float:
        """Mass of one leg [kg]."""
        return (
            self.hip_yaw_mass
            + self.hip_roll_mass
            + self.thigh_mass
            + self.shank_mass
            + self.ankle_mass
            + self.foot_mass
        )

    @property
    def total_mass(self) -> float:
        """Mass of the robot [kg]."""
        return self.torso_mass + 2 * self.leg_mass

    @property
    def stretched_leg_length(self) -> float:
        """Height of the hip line above the floor with straight knees [m]."""
        return self.thigh_length + self.shank_length + self.ankle_height

    @property
    def thigh_com_below_hip(self) -> float:
        """Distance from hip to the CoM of the thigh [m]."""
        return self.limb_com_fraction * self.thigh_length

    @property
    def shank_com_below_knee(self) -> float:
        """Distance from knee to the CoM of the shank [m]."""
        return self.limb_com_fraction * self.shank_length

    @property
    def foot_com_below_ankle(self) -> float:
        """Distance along z from ankle to the CoM of the foot, its sole's centre [m]."""
        return self.ankle_height - self.sole.length_z / 2


# Choices that the walk hardly feels, made for simplicity: the moments of inertia of
# thigh and shank are those of solid cylinders centred on the limb's CoM, although that
# lies above half length; the foot is its sole, a uniform plate, with the CoM in its
# middle; the torso is a uniform box.
BIPED = Biped(
    height=1.10,
    waist_height=0.475,
    half_hip_spacing=0.09,
    thigh_length=0.24,
    shank_length=0.24,
    ankle_height=0.06,
    limb_com_fraction=0.45,
    torso=Box(0.16, 0.24, 0.50),
    torso_com_height=0.20,
    thigh=Cylinder(radius=0.045, length_z=0.24),
    shank=Cylinder(radius=0.035, length_z=0.24),
    sole=Box(0.22, 0.14, 0.03),
    sole_ahead_of_ankle=0.02,
    joint_housing_inertia=4e-4,
    torso_mass=18.47,
    hip_yaw_mass=0.2,
    hip_roll_mass=0.2,
    thigh_mass=2.5,
    shank_mass=1.4,
    ankle_mass=0.2,
    foot_mass=0.7,
)
