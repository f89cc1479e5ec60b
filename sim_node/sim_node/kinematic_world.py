"""A plant without contact: every joint is where its reference is, whatever it takes.

The lower foot is anchored to the floor, the torso is upright, and the waist follows
from the joints. The ZMP is that of the links as point masses, with the accelerations of
semi-implicit Euler: what the floor would have to feel, were the soles large enough.
Servos need no torque here, soles do not slip, and nothing falls.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

import numpy as np

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from biped_description.multilink_zmp import multilink_zmp
from biped_description.robot import Robot
from biped_description.settings import RobotSettings
from sim_node.contact import NO_CONTACT, FloorContact
from sim_node.errors import SnapshotError
from sim_node.physics import Array, Physics, Vector, WaistState
from sim_node.servo import IDEAL_SERVO, ServoSettings

_NO_TORQUE = np.zeros(len(JOINT_NAMES))
_UPRIGHT = (0.0, 0.0, 0.0, 1.0)
_ON_THE_FLOOR = np.array([1.0, 1.0, 0.0])
# A foot is the lower one by more than rounding [m].
_LOWER_M = 1e-12
# A sole as near to the floor as this carries load [m].
_TOUCHES_M = 1e-6


class _State(NamedTuple):
    """All that the next step depends on; arrays are replaced, never written to."""

    feet: Array
    """(2, 3) left and right, world frame [m]."""
    anchored: int
    """Which of them does not move."""
    waist: Array
    """(3,) [m]"""
    waist_velocity: Array
    """(3,) [m/s]"""
    coms: Array
    """(13, 3) of the links [m]."""
    coms_before: Array
    """(13, 3) one tick ago [m]."""


class KinematicWorld(Physics):
    """See `Physics`; friction and torque limits have no effect here."""

    def __init__(
        self,
        robot: Robot,
        friction: float,
        torque_limits_nm: Array,
        servo: ServoSettings = IDEAL_SERVO,
    ) -> None:
        """Stand at the origin with stretched legs."""
        del friction, torque_limits_nm, servo
        self._robot = robot
        self._masses = robot.link_masses_kg
        self._handles = itertools.count()
        self._kept: dict[int, _State] = {}
        self._push: Vector = (0.0, 0.0, 0.0)
        height = robot.settings.stretched_leg_length_m
        self.place(np.array([0.0, 0.0, height]), np.zeros(len(JOINT_NAMES)))

    def set_mass_factors(self, factors: Array) -> None:
        """Scale the nominal mass of the (13,) links."""
        self._masses = self._robot.link_masses_kg * factors

    # -- motion --------------------------------------------------------------------

    def place(self, waist: Array, q: Array) -> None:
        """Put the robot at rest, upright, with its waist and joints as given."""
        (coms,) = self._robot.link_com_positions(waist[None], q[None])
        self._state = _State(
            feet=waist + self._feet_from_waist(q),
            anchored=0,
            waist=waist,
            waist_velocity=np.zeros(3),
            coms=coms,
            coms_before=coms,
        )

    def push(self, force_n: Vector) -> None:
        """Push the torso at its CoM during the next tick: a moment on the ZMP."""
        self._push = force_n

    def step(self, q: Array, dq: Array, joints: Array) -> FloorContact:
        """Move every joint to its next reference."""
        old = self._state
        q = q + CONTROL_PERIOD_S * dq
        joints[:] = np.concatenate([q, dq, _NO_TORQUE])
        feet_from_waist = self._feet_from_waist(q)
        anchored = old.anchored
        if feet_from_waist[1 - anchored, 2] < feet_from_waist[anchored, 2] - _LOWER_M:
            anchored = 1 - anchored
        waist = old.feet[anchored] * _ON_THE_FLOOR - feet_from_waist[anchored]
        (coms,) = self._robot.link_com_positions(waist[None], q[None])
        push_x, push_y, _ = self._push
        zmp_x, zmp_y, load = multilink_zmp(
            old.coms_before,
            old.coms,
            coms,
            CONTROL_PERIOD_S,
            self._masses,
            push_x,
            push_y,
            old.coms[0, 2],
        )
        feet = waist + feet_from_waist
        self._state = _State(
            feet=feet,
            anchored=anchored,
            waist=waist,
            waist_velocity=(waist - old.waist) / CONTROL_PERIOD_S,
            coms=coms,
            coms_before=old.coms,
        )
        self._push = (0.0, 0.0, 0.0)
        return _contact(zmp_x, zmp_y, load, feet, self._robot.settings)

    # -- readings ------------------------------------------------------------------

    def waist(self) -> WaistState:
        """Return where the waist is and how it moves."""
        x, y, z = self._state.waist.tolist()
        vx, vy, vz = self._state.waist_velocity.tolist()
        return WaistState((x, y, z), (vx, vy, vz))

    def torso_orientation(self) -> tuple[float, float, float, float]:
        """Return that the torso is upright, as a quaternion (x, y, z, w)."""
        return _UPRIGHT

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state; return its handle."""
        handle = next(self._handles)
        self._kept[handle] = self._state
        return handle

    def load(self, handle: int) -> None:
        """Go back to a kept state."""
        try:
            self._state = self._kept[handle]
        except KeyError:
            raise SnapshotError(f"state {handle} is not kept by this world") from None

    def release(self, handle: int) -> None:
        """Forget a kept state."""
        self._kept.pop(handle, None)

    def close(self) -> None:
        """Forget all kept states."""
        self._kept.clear()

    def _feet_from_waist(self, q: Array) -> Array:
        """Return the (2, 3) positions of left and right foot from the waist."""
        return np.concatenate(self._robot.waist_to_feet(q[None]))


def _contact(
    zmp_x: float, zmp_y: float, load: float, feet: Array, sole: RobotSettings
) -> FloorContact:
    """Share the load between the soles on the floor, by the ZMP's place."""
    if not load > 0.0:
        return NO_CONTACT
    (left_x, left_y, left_z), (right_x, right_y, right_z) = feet.tolist()
    if right_z > _TOUCHES_M:
        share = 0.0
    elif left_z > _TOUCHES_M:
        share = 1.0
    else:
        # From the outer edge of the left sole to that of the right one, on the line
        # through both centres.
        across_x, across_y = right_x - left_x, right_y - left_y
        apart = math.hypot(across_x, across_y)
        across_x, across_y = across_x / apart, across_y / apart
        half = 0.5 * (
            abs(across_x) * sole.sole_length_m + abs(across_y) * sole.sole_width_m
        )
        zmp = (zmp_x - sole.sole_ahead_of_ankle_m - left_x) * across_x
        zmp += (zmp_y - left_y) * across_y
        share = min(max((zmp + half) / (apart + 2.0 * half), 0.0), 1.0)
    return FloorContact(zmp_x, zmp_y, (1.0 - share) * load, share * load, 0.0)
