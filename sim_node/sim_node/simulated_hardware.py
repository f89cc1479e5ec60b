"""A plant with nothing but its sensors to tell of it: noisy, and late.

It stands for the motors and sensors of a real robot: the walk is guided by what comes
out of here, and where the robot truly is, is nobody's to know.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Any

import numpy as np
from numba import njit

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from msgs_json.end_cause import EndCause
from sim_node.contact import NO_CONTACT, FloorContact
from sim_node.errors import PlantStoppedError
from sim_node.observer import rotation
from sim_node.physics import Array, Physics, Vector
from sim_node.sensors import SensorReading
from sim_node.settings import SensorSettings

_N_JOINTS = len(JOINT_NAMES)


class SimulatedHardware:
    """Drives a plant, and reads its sensors."""

    def __init__(
        self,
        plant: Physics,
        robot: Robot,
        settings: SensorSettings,
        rng: np.random.Generator,
    ) -> None:
        """Take over a plant.

        Args:
            plant: that is driven, and closed with this object.
            robot: that stands in it.
            settings: noise and delay.
            rng: of the noise; nothing is drawn where there is none.
        """
        self.plant = plant
        self.contact = NO_CONTACT
        """What the floor truly felt in the last tick."""
        self._robot = robot
        self._settings = settings
        self._rng = rng
        self._joint_noise = np.repeat(
            [
                settings.joint_position_noise_rad,
                settings.joint_velocity_noise_rad_s,
                settings.joint_torque_noise_nm,
            ],
            _N_JOINTS,
        )
        self._sole_noise = np.array(
            [
                settings.force_noise_n,
                settings.moment_noise_nm,
                settings.moment_noise_nm,
            ]
        )
        self._velocity = np.zeros(3)
        self._late: deque[SensorReading] = deque(maxlen=1 + settings.delay_ticks)
        self._kept: dict[int, tuple[Array, tuple[SensorReading, ...]]] = {}

    def ready(self) -> bool:
        """Return True: nobody has to put the robot on its feet."""
        return True

    def place(self, waist: Array, q: Array) -> None:
        """Put the robot at rest, upright; see `Physics.place`."""
        self.plant.place(waist, q)
        self._velocity = np.zeros(3)
        self._late.clear()

    def plan(self, positions: Array) -> None:
        """Do nothing: time goes on with each exchange."""

    def exchange(self, q: Array, dq: Array) -> SensorReading:
        """Drive the joints for one control tick; return the readings that are there.

        Args:
            q: (12,) reference positions now [rad].
            dq: (12,) reference velocities until the next tick [rad/s].

        Raises:
            PlantStoppedError: the physics has come to what is no number.
        """
        joints = np.empty(3 * _N_JOINTS)
        self.contact = self.plant.step(q, dq, joints)
        # Without load, the ZMP's place means nothing.
        felt = self.contact if self.contact.loaded else self.contact[2:]
        if not math.isfinite(joints.sum() + sum(felt)):
            raise PlantStoppedError(EndCause.PHYSICS_NAN)
        velocity = np.array(self.plant.waist().velocity)
        acceleration = (velocity - self._velocity) / CONTROL_PERIOD_S
        acceleration[2] += GRAVITY_M_S2
        self._velocity = velocity
        orientation = np.array(self.plant.torso_orientation())
        torso = rotation(orientation)
        reading = SensorReading(
            joints,
            orientation,
            torso.T @ acceleration,
            self._soles(joints[:_N_JOINTS], torso),
        )
        if self._settings.noisy:
            reading = self._noisy(reading)
        self._late.append(reading)
        # Before the first one is old enough, it is all there is.
        return self._late[0]

    def push(self, force_n: Vector) -> None:
        """Push the torso during the next control tick."""
        self.plant.push(force_n)

    def set_mass_factors(self, factors: Array) -> None:
        """Scale the nominal mass and inertia of the (13,) links."""
        self.plant.set_mass_factors(factors)

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state; return its handle."""
        handle = self.plant.save()
        self._kept[handle] = self._velocity, tuple(self._late)
        return handle

    def load(self, handle: int) -> tuple[SensorReading, ...]:
        """Go back to a kept state, bit for bit; nothing was read there since."""
        self.plant.load(handle)
        self._velocity, late = self._kept[handle]
        self._late.clear()
        self._late.extend(late)
        return ()

    def release(self, handle: int) -> None:
        """Forget a kept state."""
        self.plant.release(handle)
        self._kept.pop(handle, None)

    def stop(self) -> None:
        """Do nothing: no time goes on without an exchange."""

    def close(self) -> None:
        """End the plant; harmless when repeated."""
        self.plant.close()

    # -- sensors -------------------------------------------------------------------

    def _soles(self, q: Array, torso: Array) -> Array:
        """Return the soles' (2, 3) wrenches.

        A plant tells each sole's load, but one ZMP for both: in double support the
        centres of pressure are put equally far from their ankles. Their sum is true.
        """
        contact: FloorContact = self.contact
        soles = np.zeros((2, 3))
        load = contact.left_load_n + contact.right_load_n
        if not (load > 0.0 and np.isfinite(q).all()):
            return soles
        feet, orientations = self._robot.foot_poses(q[None])
        waist = np.array(self.plant.waist().position)
        _press(contact, waist, torso, feet[:, 0], orientations[:, 0], soles)
        return soles

    def _noisy(self, reading: SensorReading) -> SensorReading:
        draw, settings = self._rng.standard_normal, self._settings
        turn = 0.5 * settings.orientation_noise_rad * draw(3)
        return SensorReading(
            reading.joints + self._joint_noise * draw(3 * _N_JOINTS),
            _turned(reading.orientation, turn),
            reading.acceleration + settings.acceleration_noise_m_s2 * draw(3),
            reading.soles + self._sole_noise * draw((2, 3)),
        )


@njit(cache=True)
def _press(
    contact: Any, waist: Any, torso: Any, positions: Any, orientations: Any, soles: Any
) -> None:
    """Fill the (2, 3) wrenches of the soles; see `SimulatedHardware._soles`."""
    loads = (contact[2], contact[3])
    left, right = waist + torso @ positions[0], waist + torso @ positions[1]
    ankles = (loads[0] * left + loads[1] * right) / (loads[0] + loads[1])
    from_ankle = np.array([contact[0] - ankles[0], contact[1] - ankles[1], 0.0])
    for side in range(2):
        foot = torso @ np.ascontiguousarray(orientations[side])
        in_foot = foot.T @ from_ankle
        soles[side, 0] = loads[side]
        soles[side, 1] = loads[side] * in_foot[1]
        soles[side, 2] = -loads[side] * in_foot[0]


@njit(cache=True)
def _turned(quaternion: Any, half_turn: Any) -> Any:
    """Return an orientation (x, y, z, w), turned by a small vector about its axes."""
    x, y, z, w = quaternion
    a, b, c = half_turn
    turned = np.array(
        [
            x + w * a + y * c - z * b,
            y + w * b + z * a - x * c,
            z + w * c + x * b - y * a,
            w - x * a - y * b - z * c,
        ]
    )
    return turned / np.sqrt((turned**2).sum())
