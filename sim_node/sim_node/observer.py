"""What a walk has to know of the robot, from its sensors alone.

Leg odometry: the foot that carries the robot stands where it was put down, flat on the
floor, and the waist follows from the leg's joints and the IMU's tilt. A second-order
complementary filter joins that position with the IMU's acceleration, since neither is
good for the other's purpose: joints differentiated twice are noise, acceleration
integrated twice runs away. The ZMP is that of the soles' wrenches.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from sim_node.contact import FloorContact
from sim_node.physics import Array, WaistState
from sim_node.sensors import SensorReading

# The leg's position corrects the integrated acceleration within about 1 / this [rad/s].
_BANDWIDTH_RAD_S = 10.0
# Critically damped: of the position's error, per tick.
_POSITION_GAIN = 2.0 * _BANDWIDTH_RAD_S * CONTROL_PERIOD_S
_VELOCITY_GAIN = _BANDWIDTH_RAD_S**2 * CONTROL_PERIOD_S
# A sole that carries less than this share of the weight is in the air.
_LOADED_SHARE = 0.02
# The foot that carries this share of the load becomes the one that stands; more than
# half, so that noise in double support does not change feet to and fro.
_STANDS_SHARE = 0.6


_UPRIGHT = np.array([0.0, 0.0, 0.0, 1.0])


class ObserverState(NamedTuple):
    """All that the next update depends on; arrays are replaced, never written to."""

    standing: int
    """The foot that does not move: 0 left, 1 right."""
    foot: Array
    """(2,) where it stands, world frame [m]."""
    waist: Array
    """(3,) world frame [m]."""
    velocity: Array
    """(3,) of the waist [m/s]."""
    torso: Array
    """(4,) orientation of the torso in the world, quaternion (x, y, z, w)."""


class Observer:
    """Follows one robot, tick by tick, from where it was put on its feet."""

    def __init__(self, robot: Robot) -> None:
        """Wait for `start`."""
        self._robot = robot
        self._loaded_n = _LOADED_SHARE * robot.mass_kg * GRAVITY_M_S2

    def start(self, waist: Array, q: Array) -> None:
        """Begin at rest, upright, the left foot flat on the floor.

        Args:
            waist: (3,) world frame [m].
            q: (12,) joint positions [rad].
        """
        (left, _), _ = self._robot.foot_poses(q[None])
        self.state = ObserverState(
            0, waist[:2] + left[0, :2], waist, np.zeros(3), _UPRIGHT
        )

    def update(self, reading: SensorReading) -> FloorContact:
        """Take in the readings of the next control tick; return what the floor felt.

        Args:
            reading: finite numbers.
        """
        old = self.state
        positions, orientations = self._robot.foot_poses(reading.joints[None, :12])
        *state, contact = _update(
            old.standing,
            old.foot,
            old.waist,
            old.velocity,
            positions[:, 0],
            orientations[:, 0],
            reading.orientation,
            reading.acceleration,
            reading.soles,
            self._loaded_n,
        )
        self.state = ObserverState(*state)
        return FloorContact(*contact)

    @property
    def waist(self) -> WaistState:
        """Where the waist is and how it moves."""
        x, y, z = self.state.waist.tolist()
        vx, vy, vz = self.state.velocity.tolist()
        return WaistState((x, y, z), (vx, vy, vz))

    @property
    def torso_orientation(self) -> tuple[float, float, float, float]:
        """The torso's orientation, a quaternion (x, y, z, w)."""
        x, y, z, w = self.state.torso.tolist()
        return x, y, z, w

    @property
    def tilt_rad(self) -> float:
        """Angle between the torso's axis and the vertical."""
        x, y, _, _ = self.state.torso.tolist()
        return 2.0 * math.asin(min(1.0, math.hypot(x, y)))


@njit(cache=True)
def rotation(quaternion: Any) -> Any:
    """Return the (3, 3) rotation of a unit quaternion (x, y, z, w)."""
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


@njit(cache=True)
def _update(
    standing: int,
    foot: Any,
    waist: Any,
    velocity: Any,
    positions: Any,
    orientations: Any,
    quaternion: Any,
    specific_force: Any,
    soles: Any,
    loaded_n: float,
) -> Any:
    """Return the next state, its fields in order, and the numbers of a `FloorContact`.

    Args:
        standing: of the state before, as are foot, waist and velocity.
        foot: (2,)
        waist: (3,)
        velocity: (3,)
        positions: (2, 3) of the feet in the torso's frame.
        orientations: (2, 3, 3) of the feet in the torso's frame.
        quaternion: of the IMU.
        specific_force: (3,) in the torso's axes [m/s^2].
        soles: (2, 3) wrenches.
        loaded_n: force from which on a sole carries load.
    """
    quaternion = quaternion / np.sqrt((quaternion**2).sum())
    imu = rotation(quaternion)
    # An IMU's heading drifts, or begins anywhere. The gait walks straight ahead: the
    # foot that stands points forward, and so the torso's heading is known from the leg.
    ahead = imu @ np.ascontiguousarray(orientations[standing, :, 0])
    half = -0.5 * math.atan2(ahead[1], ahead[0])
    cos, sin = math.cos(half), math.sin(half)
    x, y, z, w = quaternion
    orientation = np.array(
        [cos * x - sin * y, cos * y + sin * x, cos * z + sin * w, cos * w - sin * z]
    )
    torso = rotation(orientation)

    acceleration = torso @ specific_force
    acceleration[2] -= GRAVITY_M_S2
    dt = CONTROL_PERIOD_S
    by_leg = np.array([foot[0], foot[1], 0.0]) - torso @ positions[standing]
    waist = waist + dt * velocity + (0.5 * dt * dt) * acceleration
    error = by_leg - waist
    waist = waist + _POSITION_GAIN * error
    velocity = velocity + dt * acceleration + _VELOCITY_GAIN * error

    # Moments count also of a sole that hardly touches: what is left out there would
    # shift the ZMP by millimetres, what noise there is does so by tenths.
    zmp = np.zeros(3)
    for side in range(2):
        moment = np.array([-soles[side, 2], soles[side, 1], 0.0])
        turned = np.ascontiguousarray(orientations[side]) @ moment
        zmp += soles[side, 0] * by_leg + torso @ (
            soles[side, 0] * positions[side] + turned
        )
    load = soles[:, 0].sum()
    if load < loaded_n:
        return standing, foot, waist, velocity, orientation, (0.0, 0.0, 0.0, 0.0, 0.0)
    zmp /= load
    other = 1 - standing
    if soles[other, 0] > _STANDS_SHARE * load:
        standing = other
        foot = (by_leg + torso @ positions[other])[:2].copy()
    left = soles[0, 0] if soles[0, 0] >= loaded_n else 0.0
    right = soles[1, 0] if soles[1, 0] >= loaded_n else 0.0
    contact = (zmp[0], zmp[1], left, right, 0.0)
    return standing, foot, waist, velocity, orientation, contact
