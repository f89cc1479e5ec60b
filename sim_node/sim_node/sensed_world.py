"""A robot that is known by its sensors only, behind the seam of the engines.

To the walk it is a plant as any other, so that limits, cost and observations of a real
robot are made by what makes those of a simulated one; but whatever this plant says of
floor and waist is the observer's estimate.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from biped_description.robot import Robot
from msgs_json.end_cause import EndCause
from sim_node.contact import FloorContact
from sim_node.errors import PlantStoppedError
from sim_node.observer import Observer, ObserverState
from sim_node.physics import Array, Physics, Vector, WaistState
from sim_node.sensors import SensorReading


class Hardware(Protocol):
    """Motors and sensors; one that cannot go on raises `PlantStoppedError`."""

    def ready(self) -> bool:
        """Return whether a walk can begin."""

    def place(self, waist: Array, q: Array) -> None:
        """Have the robot stand at rest, upright: waist (3,) [m], joints (12,) [rad]."""

    def plan(self, positions: Array) -> None:
        """Take note of where the joints will be asked to be; see `Physics.plan`."""

    def exchange(self, q: Array, dq: Array) -> SensorReading:
        """Drive the joints for one control tick; return the readings after it."""

    def push(self, force_n: Vector) -> None:
        """Push the torso, where that can be done; see `Physics.push`."""

    def set_mass_factors(self, factors: Array) -> None:
        """Change the links, where that can be done; see `Physics`."""

    def save(self) -> int:
        """Keep the present state; return its handle."""

    def load(self, handle: int) -> Sequence[SensorReading]:
        """Go back to a kept state; return what was read there since it was kept.

        Nothing is, where a state comes back bit for bit.
        """

    def release(self, handle: int) -> None:
        """Forget a kept state."""

    def stop(self) -> None:
        """Have the joints stay: a walk was ended by whoever guides the robot."""

    def close(self) -> None:
        """Let go of the robot; harmless when repeated."""


class SensedWorld(Physics):
    """See `Physics`; a fault of the sensors, or a fall, raises `PlantStoppedError`."""

    def __init__(self, robot: Robot, hardware: Hardware, tilt_limit_rad: float) -> None:
        """Take over a robot's hardware.

        Args:
            robot: as it is planned with.
            hardware: motors and sensors of it; closed with this object.
            tilt_limit_rad: of the torso, from which on a walk has ended.
        """
        self.hardware = hardware
        self._tilt_limit_rad = tilt_limit_rad
        self._observer = Observer(robot)
        self._kept: dict[int, ObserverState] = {}

    def ready(self) -> bool:
        """Return whether a walk can begin."""
        return self.hardware.ready()

    def set_mass_factors(self, factors: Array) -> None:
        """Have the links differ from what is planned with."""
        self.hardware.set_mass_factors(factors)

    # -- motion --------------------------------------------------------------------

    def plan(self, positions: Array) -> None:
        """Take note of where the joints will be asked to be."""
        self.hardware.plan(positions)

    def place(self, waist: Array, q: Array) -> None:
        """Have the robot stand; what is estimated begins there."""
        self.hardware.place(waist, q)
        self._observer.start(waist, q)

    def push(self, force_n: Vector) -> None:
        """Push the torso during the next control tick."""
        self.hardware.push(force_n)

    def step(self, q: Array, dq: Array, joints: Array) -> FloorContact:
        """Drive the joints for one control tick, and observe what came of it.

        Raises:
            PlantStoppedError: the walk cannot go on.
        """
        reading = self.hardware.exchange(q, dq)
        if not reading.usable:
            raise PlantStoppedError(EndCause.SENSORS_INVALID)
        joints[:] = reading.joints
        contact = self._observer.update(reading)
        if self._observer.tilt_rad > self._tilt_limit_rad:
            raise PlantStoppedError(EndCause.TILT)
        return contact

    # -- readings ------------------------------------------------------------------

    def waist(self) -> WaistState:
        """Return where the waist seems to be, and how it seems to move."""
        return self._observer.waist

    def torso_orientation(self) -> tuple[float, float, float, float]:
        """Return the torso's orientation, a quaternion (x, y, z, w)."""
        return self._observer.torso_orientation

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state; return its handle."""
        handle = self.hardware.save()
        self._kept[handle] = self._observer.state
        return handle

    def load(self, handle: int) -> None:
        """Go back to a kept state."""
        readings = self.hardware.load(handle)
        self._observer.state = self._kept[handle]
        for reading in readings:
            self._observer.update(reading)

    def release(self, handle: int) -> None:
        """Forget a kept state."""
        self.hardware.release(handle)
        self._kept.pop(handle, None)

    def stop(self) -> None:
        """Have the joints stay."""
        self.hardware.stop()

    def close(self) -> None:
        """Let go of the hardware."""
        self.hardware.close()
