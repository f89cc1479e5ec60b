"""The seam to a physics engine: what a plant can do. World frame, SI units.

A plant is a floor at z = 0 with one robot, stepped one control tick of 2 ms at a time.
Several live in one process without feeling each other. Joints are in the order of
`JOINT_NAMES`, links in that of `LINK_NAMES`. docs/extend.md says how to add one.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from biped_description.robot import Robot
from sim_node.contact import FloorContact

Vector: TypeAlias = tuple[float, float, float]
Numbers: TypeAlias = tuple[float, ...]


class WaistState(NamedTuple):
    """Where the torso is: its frame has the waist as its origin."""

    position: Vector
    """[m]"""
    velocity: Vector
    """[m/s]"""


class Physics(Protocol):
    """One plant. Numbers that the physics leaves undefined are handed out as NaN."""

    def __init__(
        self, robot: Robot, friction: float, torque_limits_nm: NDArray[np.float64]
    ) -> None:
        """Build the plant.

        Args:
            robot: that stands in it.
            friction: lateral, between sole and floor [].
            torque_limits_nm: (12,) that the servos can reach.
        """

    def set_mass_factors(self, factors: NDArray[np.float64]) -> None:
        """Scale the nominal mass and inertia of the (13,) links."""

    # -- motion --------------------------------------------------------------------

    def place(self, waist: NDArray[np.float64], q: NDArray[np.float64]) -> None:
        """Put the robot at rest, upright: waist (3,) [m], joints (12,) [rad]."""

    def command(self, q: list[float], dq: list[float]) -> None:
        """Tell the servos where the joints are to be.

        Args:
            q: (12,) reference positions now [rad].
            dq: (12,) reference velocities until the next tick [rad/s].
        """

    def push(self, force_n: Vector) -> None:
        """Push the torso at its CoM during the next control tick."""

    def step(self) -> None:
        """Go on by one control tick."""

    # -- readings, after a step ----------------------------------------------------

    def joints(self) -> tuple[Numbers, Numbers, Numbers]:
        """Return what the joints measure, (12,) each.

        Returns:
            Positions [rad], velocities [rad/s] and torques of the servos [N m].
        """

    def contact(self, before: FloorContact) -> FloorContact:
        """Return what the floor felt in the last step.

        Args:
            before: what it felt a tick ago. With no load on either foot there is no
                ZMP; loads are zero then, and that of `before` is held.
        """

    def waist(self) -> WaistState:
        """Return where the waist is and how it moves."""

    def torso_orientation(self) -> tuple[float, float, float, float]:
        """Return the torso's orientation, a quaternion (x, y, z, w)."""

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state; return its handle."""

    def load(self, handle: int) -> None:
        """Go back to a kept state, bit for bit.

        Raises:
            SnapshotError: it is not kept by this plant.
        """

    def release(self, handle: int) -> None:
        """Forget a kept state."""

    def close(self) -> None:
        """Free what the plant holds; harmless when repeated."""
