"""The world by PyBullet's Python functions: plain, and what ours must agree with."""

from tempfile import NamedTemporaryFile
from typing import Any

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from biped_description.links import CONTACT_LINKS
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from sim_node.contact import FloorContact
from sim_node.errors import SnapshotError
from sim_node.physics import Physics, Vector, WaistState
from sim_node.quiet import engine_chatter_dropped

with engine_chatter_dropped():
    import pybullet

_BASE_LINK = -1
# Of an ideal servo.
_POSITION_SHARE, _VELOCITY_SHARE = 0.5, 1.0
# Places in what `getJointInfo` returns.
_JOINT_NAME, _LINK_NAME = 1, 12
# Places in a contact point, with the robot as body A.
_LINK_A, _POSITION_ON_B, _DISTANCE, _NORMAL_FORCE = 3, 6, 8, 9


class PlainWorld(Physics):
    """Floor and robot in a world of their own."""

    def __init__(
        self, robot: Robot, friction: float, torque_limits_nm: NDArray[np.float64]
    ) -> None:
        """Open a world, with the robot standing at the origin."""
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
        self.robot: int = self._load_robot(robot)
        self._torso_com_height_m = robot.settings.torso_com_height_m
        # The engine gives a joint and the link that it moves the same number.
        numbers = self._numbers()
        self.joint_numbers: list[int] = [numbers[name] for name in JOINT_NAMES]
        self.left_sole, self.right_sole = (numbers[name] for name in CONTACT_LINKS)
        self._links = [_BASE_LINK, *self.joint_numbers]
        self._masses = [self._dynamics(link)[0] for link in self._links]
        self._inertias = [self._dynamics(link)[2] for link in self._links]
        for link in self._links:
            self._change_dynamics(
                self.robot,
                link,
                linearDamping=0.0,
                angularDamping=0.0,
                jointDamping=0.0,
                rollingFriction=0.0,
                spinningFriction=0.0,
                restitution=0.0,
            )
        # The engine multiplies the coefficients of the two bodies; the floor's is 1.
        for sole in (self.left_sole, self.right_sole):
            self._change_dynamics(self.robot, sole, lateralFriction=friction)
        # The engine's default velocity motors would brake every joint.
        n_joints = len(self.joint_numbers)
        pybullet.setJointMotorControlArray(
            self.robot,
            self.joint_numbers,
            pybullet.VELOCITY_CONTROL,
            forces=[0.0] * n_joints,
            physicsClientId=self.client,
        )
        self._servo = (
            torque_limits_nm.tolist(),
            [_POSITION_SHARE] * n_joints,
            [_VELOCITY_SHARE] * n_joints,
            self.client,
        )

    def set_mass_factors(self, factors: NDArray[np.float64]) -> None:
        """Scale the nominal mass and inertia of the (13,) links."""
        for link, mass, inertia, factor in zip(
            self._links, self._masses, self._inertias, factors, strict=True
        ):
            self._change_dynamics(
                self.robot,
                link,
                mass=mass * factor,
                localInertiaDiagonal=[moment * factor for moment in inertia],
            )

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
        for joint, position in zip(self.joint_numbers, q.tolist(), strict=True):
            pybullet.resetJointState(
                self.robot, joint, position, 0.0, physicsClientId=self.client
            )

    def step(self, q, dq, joints) -> FloorContact:
        pybullet.setJointMotorControlArray(
            self.robot,
            self.joint_numbers,
            pybullet.POSITION_CONTROL,
            q.tolist(),
            dq.tolist(),
            *self._servo,
        )
        pybullet.stepSimulation(self.client)
        states = pybullet.getJointStates(self.robot, self.joint_numbers, self.client)
        position, velocity, _, torque = zip(*states)  # noqa: B905
        joints[:] = [*position, *velocity, *torque]
        points = pybullet.getContactPoints(
            self.robot, self.floor, physicsClientId=self.client
        )
        return floor_contact(points, self.left_sole)

    def push(self, force_n: Vector) -> None:
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

    def waist(self) -> WaistState:
        """Return where the waist is and how it moves."""
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
        return WaistState(
            (x + dx, y + dy, z + dz),
            (
                vx + (wy * dz - wz * dy),
                vy + (wz * dx - wx * dz),
                vz + (wx * dy - wy * dx),
            ),
        )

    def torso_orientation(self) -> tuple[float, float, float, float]:
        """Return the torso's orientation, a quaternion (x, y, z, w)."""
        _, (x, y, z, w) = pybullet.getBasePositionAndOrientation(
            self.robot, physicsClientId=self.client
        )
        return x, y, z, w

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

    # -- set-up --------------------------------------------------------------------

    def _make_floor(self) -> int:
        shape = pybullet.createCollisionShape(
            pybullet.GEOM_PLANE, physicsClientId=self.client
        )
        floor: int = pybullet.createMultiBody(
            baseMass=0.0, baseCollisionShapeIndex=shape, physicsClientId=self.client
        )
        self._change_dynamics(
            floor,
            _BASE_LINK,
            lateralFriction=1.0,
            rollingFriction=0.0,
            spinningFriction=0.0,
            restitution=0.0,
        )
        return floor

    def _load_robot(self, robot: Robot) -> int:
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

    def _change_dynamics(self, body: int, link: int, **values: Any) -> None:
        pybullet.changeDynamics(body, link, physicsClientId=self.client, **values)


def floor_contact(points: Any, left_sole: int) -> FloorContact:
    left = right = moment_x = moment_y = 0.0
    nearest = 0.0
    for point in points:
        force = point[_NORMAL_FORCE]
        nearest = min(nearest, point[_DISTANCE])
        if force > 0.0:
            moment_x += force * point[_POSITION_ON_B][0]
            moment_y += force * point[_POSITION_ON_B][1]
            if point[_LINK_A] == left_sole:
                left += force
            else:
                right += force
    load = left + right
    if load > 0.0:
        return FloorContact(moment_x / load, moment_y / load, left, right, -nearest)
    return FloorContact(0.0, 0.0, 0.0, 0.0, -nearest)
