"""Solid bodies of uniform density, and how hard they are to turn."""

from typing import NamedTuple


class Box(NamedTuple):
    """Edges along the axes of its link."""

    length_x: float  # [m]
    length_y: float  # [m]
    length_z: float  # [m]

    def inertia(self, mass: float) -> tuple[float, float, float]:
        """Return the principal moments (ixx, iyy, izz) about the centre [kg m^2]."""
        xx, yy, zz = self.length_x**2, self.length_y**2, self.length_z**2
        return mass * (yy + zz) / 12, mass * (xx + zz) / 12, mass * (xx + yy) / 12


class Cylinder(NamedTuple):
    """Axis along z."""

    radius: float  # [m]
    length_z: float  # [m]

    def inertia(self, mass: float) -> tuple[float, float, float]:
        """Return the principal moments (ixx, iyy, izz) about the centre [kg m^2]."""
        across = mass * (3 * self.radius**2 + self.length_z**2) / 12
        return across, across, mass * self.radius**2 / 2
