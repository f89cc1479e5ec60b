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
from sim_node.servo import IDEAL_SERVO, ServoSettings

Vector: TypeAlias = tuple[float, float, float]
Array: TypeAlias = NDArray[np.float64]


class WaistState(NamedTuple):
    """Where the torso is: its frame has the waist as its origin."""

    position: Vector
    """[m]"""
    velocity: Vector
    """[m/s]"""


class Physics(Protocol):
    """One plant. Numbers that the physics leaves undefined are handed out as NaN."""

    def __init__(
        self,
        robot: Robot,
        friction: float,
        torque_limits_nm: Array,
        servo: ServoSettings = IDEAL_SERVO,
    ) -> None:
        """Build the plant.

        Args:
            robot: that stands in it.
            friction: lateral, between sole and floor [].
            torque_limits_nm: (12,) that the servos can reach.
            servo: one of those that the table of engines says it has.
        """

    def ready(self) -> bool:
        """Return whether a walk can begin; a real robot is put on its feet by hand."""
        return True

    def set_mass_factors(self, factors: Array) -> None:
        """Scale the nominal mass and inertia of the (13,) links."""

    # -- motion --------------------------------------------------------------------

    def plan(self, positions: Array) -> None:
        """Take note of where the joints will be asked to be: (ticks, 12) [rad].

        Only a plant that keeps its own time needs to know.
        """

    def place(self, waist: Array, q: Array) -> None:
        """Put the robot at rest, upright: waist (3,) [m], joints (12,) [rad]."""

    def push(self, force_n: Vector) -> None:
        """Push the torso at its CoM during the next control tick."""

    def step(self, q: Array, dq: Array, joints: Array) -> FloorContact:
        """Drive the joints for one control tick, and read the sensors.

        Args:
            q: (12,) reference positions now [rad].
            dq: (12,) reference velocities until the next tick [rad/s].
            joints: (36,) filled with the measured positions [rad], velocities [rad/s]
                and torques of the servos [N m].

        Returns:
            What the floor felt. With no load on either foot there is no ZMP, and its
            place is of no meaning.
        """

    # -- readings ------------------------------------------------------------------

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

    def stop(self) -> None:
        """Have the joints stay: a walk was ended by whoever guides the robot.

        Only a plant that keeps its own time needs to be told.
        """

    def close(self) -> None:
        """Free what the plant holds; harmless when repeated."""
