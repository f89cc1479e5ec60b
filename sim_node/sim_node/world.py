"""The physics: one PyBullet world with a floor and the biped.

Every call carries the client's id, so that several worlds can live in one process.
Dantzig's solver gives a ZMP clean to about 1 mm; the default sequential-impulse solver
is slower here and its contact forces ring.
"""

from __future__ import annotations

from tempfile import NamedTemporaryFile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from biped_description.links import CONTACT_LINKS
from biped_description.robot import Robot
from sim_node.errors import SnapshotError, WorldClosedError
from sim_node.quiet import engine_chatter_dropped

with engine_chatter_dropped():
    import pybullet

Vector = tuple[float, float, float]

GRAVITY_M_S2 = 9.81
# Share of its position and speed errors that the servo takes back per tick.
POSITION_GAIN = 0.5
VELOCITY_GAIN = 1.0
_BASE_LINK = -1
_ANY_LINK = -2
# Places in what `getJointInfo` returns.
_JOINT_NAME, _LINK_NAME = 1, 12


class World:
    """Floor and robot, stepped one control tick at a time."""

    def __init__(self, robot: Robot) -> None:
        """Open a world of its own, with the robot standing at the origin."""
        self.client: int = pybullet.connect(pybullet.DIRECT)
        with engine_chatter_dropped():
            pybullet.setPhysicsEngineParameter(
                fixedTimeStep=CONTROL_PERIOD_S,
                numSubSteps=0,
                constraintSolverType=pybullet.CONSTRAINT_SOLVER_LCP_DANTZIG,
                globalCFM=1e-6,
                erp=0.2,
                contactERP=0.2,
                frictionERP=0.2,
                deterministicOverlappingPairs=1,
                physicsClientId=self.client,
            )
        pybullet.setGravity(0.0, 0.0, -GRAVITY_M_S2, physicsClientId=self.client)
        self.floor: int = self._make_floor()
        self.robot: int = self._load(robot)
        self._torso_com_height_m = robot.settings.torso_com_height_m
        # The engine gives a joint and the link that it moves the same number.
        numbers = self._numbers()
        self.joints: list[int] = [numbers[name] for name in JOINT_NAMES]
        self.left_sole, self.right_sole = (numbers[name] for name in CONTACT_LINKS)
        self._links = [_BASE_LINK, *self.joints]
        self._masses = [self._dynamics(link)[0] for link in self._links]
        self._inertias = [self._dynamics(link)[2] for link in self._links]
        for link in self._links:
            pybullet.changeDynamics(
                self.robot,
                link,
                linearDamping=0.0,
                angularDamping=0.0,
                jointDamping=0.0,
                rollingFriction=0.0,
                spinningFriction=0.0,
                restitution=0.0,
                physicsClientId=self.client,
            )
        # The engine's default velocity motors would brake every joint.
        pybullet.setJointMotorControlArray(
            self.robot,
            self.joints,
            pybullet.VELOCITY_CONTROL,
            forces=[0.0] * len(self.joints),
            physicsClientId=self.client,
        )
        self.set_friction(0.9)
        self.set_torque_limits(robot.torque_limit_nm)
        self._gains = (
            [POSITION_GAIN] * len(self.joints),
            [VELOCITY_GAIN] * len(self.joints),
        )

    # -- parameters of the plant ---------------------------------------------------

    def set_friction(self, lateral_friction: float) -> None:
        """Set the lateral friction of both soles against the floor."""
        # The engine multiplies the coefficients of the two bodies.
        for link in (self.left_sole, self.right_sole):
            pybullet.changeDynamics(
                self.robot,
                link,
                lateralFriction=lateral_friction,
                physicsClientId=self.client,
            )

    def set_torque_limits(self, limits_nm: NDArray[np.float64]) -> None:
        """Set the (12,) torques that the servos can reach [N m]."""
        self.torque_limits: list[float] = limits_nm.tolist()

    def set_mass_factors(self, factors: NDArray[np.float64]) -> None:
        """Scale mass and inertia of the (13,) links, base first."""
        for link, mass, inertia, factor in zip(
            self._links, self._masses, self._inertias, factors, strict=True
        ):
            pybullet.changeDynamics(
                self.robot,
                link,
                mass=mass * factor,
                localInertiaDiagonal=[moment * factor for moment in inertia],
                physicsClientId=self.client,
            )

    @property
    def n_links(self) -> int:
        """Number of links, the base included."""
        return len(self._links)

    # -- motion --------------------------------------------------------------------

    def place(self, waist: NDArray[np.float64], q: NDArray[np.float64]) -> None:
        """Put the robot at rest, upright, with its waist and joints as given."""
        base = (waist[0], waist[1], waist[2] + self._torso_com_height_m)
        pybullet.resetBasePositionAndOrientation(
            self.robot, base, (0.0, 0.0, 0.0, 1.0), physicsClientId=self.client
        )
        pybullet.resetBaseVelocity(
            self.robot, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), physicsClientId=self.client
        )
        for joint, position in zip(self.joints, q.tolist(), strict=True):
            pybullet.resetJointState(
                self.robot, joint, position, 0.0, physicsClientId=self.client
            )

    def step(self, q: list[float], dq: list[float]) -> None:
        """Drive the joints for one control tick.

        Args:
            q: reference positions now [rad].
            dq: reference velocities until the next tick [rad/s].
        """
        self.command(q, dq)
        pybullet.stepSimulation(physicsClientId=self.client)

    def command(self, q: list[float], dq: list[float]) -> None:
        """Give the servos their references for the next tick, without stepping."""
        pybullet.setJointMotorControlArray(
            self.robot,
            self.joints,
            pybullet.POSITION_CONTROL,
            q,
            dq,
            self.torque_limits,
            *self._gains,
            self.client,
        )

    def push(self, force_n: tuple[float, float, float]) -> None:
        """Push the torso at its CoM during the next control tick."""
        position, _ = pybullet.getBasePositionAndOrientation(
            self.robot, physicsClientId=self.client
        )
        pybullet.applyExternalForce(
            self.robot,
            _BASE_LINK,
            force_n,
            position,
            pybullet.WORLD_FRAME,
            physicsClientId=self.client,
        )

    # -- readings ------------------------------------------------------------------

    def joint_states(self) -> tuple[tuple[float, ...], ...]:
        """Return the (12,) positions [rad], velocities [rad/s] and torques [N m]."""
        states = pybullet.getJointStates(self.robot, self.joints, self.client)
        position, velocity, _, torque = zip(*states)  # noqa: B905
        return position, velocity, torque

    def contacts(self) -> Any:
        """Return PyBullet's contact points, the robot as body A."""
        # By position: keywords alone take a tenth of the time.
        return pybullet.getContactPoints(
            self.robot, self.floor, _ANY_LINK, _ANY_LINK, self.client
        )

    def waist(self) -> tuple[Vector, Vector]:
        """Return position [m] and velocity [m/s] of the waist."""
        position, orientation = pybullet.getBasePositionAndOrientation(
            self.robot, physicsClientId=self.client
        )
        velocity, spin = pybullet.getBaseVelocity(
            self.robot, physicsClientId=self.client
        )
        # PyBullet speaks of the torso's CoM; the waist lies below it.
        dx, dy, dz = pybullet.rotateVector(
            orientation, (0.0, 0.0, -self._torso_com_height_m)
        )
        wx, wy, wz = spin
        x, y, z = position
        vx, vy, vz = velocity
        # Plain numbers: numpy's cross product alone would take longer than all of this.
        return (
            (x + dx, y + dy, z + dz),
            (
                vx + (wy * dz - wz * dy),
                vy + (wz * dx - wx * dz),
                vz + (wx * dy - wy * dx),
            ),
        )

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state in memory; return its handle."""
        return int(pybullet.saveState(physicsClientId=self.client))

    def load(self, handle: int) -> None:
        """Go back to a kept state, bit for bit."""
        try:
            with engine_chatter_dropped():
                pybullet.restoreState(stateId=handle, physicsClientId=self.client)
        except pybullet.error as error:
            raise SnapshotError(f"state {handle} is not kept by this world") from error

    def release(self, handle: int) -> None:
        """Forget a kept state."""
        pybullet.removeState(handle, physicsClientId=self.client)

    def close(self) -> None:
        """End the world; harmless when repeated."""
        if self.client >= 0:
            pybullet.disconnect(physicsClientId=self.client)
            self.client = -1

    def check_open(self) -> None:
        """Refuse to work on a closed world."""
        if self.client < 0:
            raise WorldClosedError("this world has been closed")

    # -- set-up --------------------------------------------------------------------

    def _make_floor(self) -> int:
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_PLANE, physicsClientId=self.client
        )
        floor: int = pybullet.createMultiBody(
            baseMass=0.0, baseCollisionShapeIndex=shape, physicsClientId=self.client
        )
        pybullet.changeDynamics(
            floor,
            _BASE_LINK,
            lateralFriction=1.0,
            rollingFriction=0.0,
            spinningFriction=0.0,
            restitution=0.0,
            physicsClientId=self.client,
        )
        return floor

    def _load(self, robot: Robot) -> int:
        # The engine reads files only.
        with NamedTemporaryFile(mode="w", suffix=".urdf", encoding="utf-8") as file:
            file.write(robot.urdf)
            file.flush()
            loaded: int = pybullet.loadURDF(
                file.name,
                basePosition=(0.0, 0.0, robot.settings.stretched_leg_length_m),
                flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
                physicsClientId=self.client,
            )
        return loaded

    def _numbers(self) -> dict[str, int]:
        """Return the engine's number of each joint and of the link that it moves."""
        count = pybullet.getNumJoints(self.robot, physicsClientId=self.client)
        infos = (
            pybullet.getJointInfo(self.robot, i, physicsClientId=self.client)
            for i in range(count)
        )
        return {
            info[name].decode(): info[0]
            for info in infos
            for name in (_JOINT_NAME, _LINK_NAME)
        }

    def _dynamics(self, link: int) -> Any:
        return pybullet.getDynamicsInfo(self.robot, link, physicsClientId=self.client)
