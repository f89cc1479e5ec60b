"""Full physics: a Bullet world with a floor and the biped.

Every call carries its client, so that several worlds can live in one process. Dantzig's
solver gives a ZMP clean to about 1 mm; the default sequential-impulse solver is slower
here and its contact forces ring.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from tempfile import NamedTemporaryFile
from typing import Any

import numpy as np

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from biped_description.links import CONTACT_LINKS
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from sim_node.bullet_api import (
    LCP_DANTZIG,
    USE_INERTIA_FROM_FILE,
    VELOCITY_CONTROL,
    WORLD_FRAME,
    JointInfo,
    api,
)
from sim_node.bullet_kernels import (
    NUMBER,
    U_INDEX,
    pulled_tick,
    read_base,
    read_joints,
    tick,
    waist_state,
)
from sim_node.bullet_rotors import gear_rotors, with_rotors
from sim_node.contact import FloorContact
from sim_node.errors import SnapshotError
from sim_node.physics import Array, Physics, Vector, WaistState
from sim_node.quiet import engine_chatter_dropped
from sim_node.servo import IDEAL_SERVO, PidServos, ServoSettings

_BASE_LINK = -1
_N_JOINTS = len(JOINT_NAMES)


class PyBulletWorld(Physics):
    """Floor and robot in a world of their own; see `Physics`."""

    def __init__(
        self,
        robot: Robot,
        friction: float,
        torque_limits_nm: Array,
        servo: ServoSettings = IDEAL_SERVO,
    ) -> None:
        """Open a world, with the robot standing at the origin."""
        self.client: int = api.b3ConnectPhysicsDirect()
        with engine_chatter_dropped():
            self._set_engine_parameters()
        self.floor = self._make_floor()
        urdf, parts = robot.urdf, _N_JOINTS
        if servo.kind == "pid":
            urdf, parts = with_rotors(urdf, servo.rotor_inertia_kg_m2), 2 * parts
        self.robot = self._load_robot(urdf, robot.settings.stretched_leg_length_m)
        self._torso_com_height_m = robot.settings.torso_com_height_m
        infos = [self._joint_info(number) for number in range(parts)]
        joints = {info.joint_name.decode(): info for info in infos}
        ordered = [joints[name] for name in JOINT_NAMES]
        self.joint_numbers = np.array(
            [
                [info.number for info in ordered],
                [info.q_index for info in ordered],
                [info.u_index for info in ordered],
            ],
            dtype=np.int32,
        )
        # The API gives a joint and the link that it moves the same number.
        links = {info.link_name.decode(): info.number for info in infos}
        self.left_sole, self.right_sole = (links[name] for name in CONTACT_LINKS)
        self._links = [_BASE_LINK, *self.joint_numbers[NUMBER].tolist()]
        self._mass_properties = np.array([self._dynamics(link) for link in self._links])
        self._moving = [info.number for info in infos]
        for link in (_BASE_LINK, *self._moving):
            self._take_away_losses(self.robot, link)
        # The API multiplies the coefficients of the two bodies; the floor's is 1.
        for sole in (self.left_sole, self.right_sole):
            self._set_friction(self.robot, sole, friction)
        self._brake([info.u_index for info in infos], 0.0)
        self._pid: PidServos | None = None
        self._remembered = np.zeros((2, _N_JOINTS))  # of PID servos
        if servo.kind == "pid":
            numbers = {name: info.number for name, info in joints.items()}
            gear_rotors(self.client, self.robot, numbers)
            self._brake(self.joint_numbers[U_INDEX].tolist(), servo.friction_nm)
            self._pid = PidServos(servo, torque_limits_nm, self._remembered)
        else:
            self.torque_limits_nm = torque_limits_nm
            self.servo_shares = np.array(servo.shares)
        self._kept: dict[int, Array] = {}

    def set_mass_factors(self, factors: Array) -> None:
        """Scale the nominal mass and inertia of the (13,) links."""
        scaled = (self._mass_properties * factors[:, None]).tolist()
        for link, (mass, *inertia) in zip(self._links, scaled, strict=True):
            command = api.b3InitChangeDynamicsInfo(self.client)
            api.b3ChangeDynamicsInfoSetMass(command, self.robot, link, mass)
            api.b3ChangeDynamicsInfoSetLocalInertiaDiagonal(
                command, self.robot, link, _doubles(inertia)
            )
            self._submit(command)

    # -- motion --------------------------------------------------------------------

    def place(self, waist: Array, q: Array) -> None:
        """Put the robot at rest, upright, with its waist and joints as given."""
        x, y, z = waist.tolist()
        command = api.b3CreatePoseCommandInit(self.client, self.robot)
        z += self._torso_com_height_m
        api.b3CreatePoseCommandSetBasePosition(command, x, y, z)
        api.b3CreatePoseCommandSetBaseOrientation(command, 0.0, 0.0, 0.0, 1.0)
        self._submit(command)
        command = api.b3CreatePoseCommandInit(self.client, self.robot)
        at_rest = _doubles((0.0, 0.0, 0.0))
        api.b3CreatePoseCommandSetBaseLinearVelocity(command, at_rest)
        api.b3CreatePoseCommandSetBaseAngularVelocity(command, at_rest)
        self._submit(command)
        positions = dict(zip(self._links[1:], q.tolist(), strict=True))
        for part in self._moving:
            command = api.b3CreatePoseCommandInit(self.client, self.robot)
            of_part = self.client, command, part
            at = positions.get(part, 0.0)  # of a rotor it does not matter
            api.b3CreatePoseCommandSetJointPosition(*of_part, at)
            api.b3CreatePoseCommandSetJointVelocity(*of_part, 0.0)
            self._submit(command)
        self._remembered[:] = 0.0

    def push(self, force_n: Vector) -> None:
        """Push the torso at its CoM during the next control tick."""
        base = np.empty(13)
        read_base(self.client, self.robot, base)
        command = api.b3ApplyExternalForceCommandInit(self.client)
        api.b3ApplyExternalForce(
            command,
            self.robot,
            _BASE_LINK,
            _doubles(force_n),
            base.ctypes.data,
            WORLD_FRAME,
        )
        self._submit(command)

    def step(self, q: Array, dq: Array, joints: Array) -> FloorContact:
        """Drive the joints for one control tick, and read the sensors."""
        client, robot, numbers = self.client, self.robot, self.joint_numbers
        where = client, robot, self.floor, self.left_sole, numbers
        if self._pid is None:
            servos = self.torque_limits_nm, self.servo_shares
            return FloorContact(*tick(*where, *servos, q, dq, joints))
        now = np.empty(3 * _N_JOINTS)
        read_joints(client, robot, numbers, now)
        position, velocity, _ = now.reshape(3, _N_JOINTS)
        torques = self._pid.pull(q - position, dq - velocity)
        return FloorContact(*pulled_tick(*where, torques, joints))

    # -- readings ------------------------------------------------------------------

    def waist(self) -> WaistState:
        """Return where the waist is and how it moves."""
        x, y, z, vx, vy, vz = waist_state(
            self.client, self.robot, self._torso_com_height_m
        )
        return WaistState((x, y, z), (vx, vy, vz))

    def torso_orientation(self) -> tuple[float, float, float, float]:
        """Return the torso's orientation, a quaternion (x, y, z, w)."""
        base = np.empty(13)
        read_base(self.client, self.robot, base)
        x, y, z, w = base[3:7].tolist()
        return x, y, z, w

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state in memory; return its handle."""
        status = self._submit(api.b3SaveStateCommandInit(self.client))
        handle: int = api.b3GetStatusGetStateId(status)
        self._kept[handle] = self._remembered.copy()
        return handle

    def load(self, handle: int) -> None:
        """Go back to a kept state, bit for bit."""
        if handle not in self._kept:
            raise SnapshotError(f"state {handle} is not kept by this world")
        command = api.b3LoadStateCommandInit(self.client)
        api.b3LoadStateSetStateId(command, handle)
        self._submit(command)
        self._remembered[:] = self._kept[handle]

    def release(self, handle: int) -> None:
        """Forget a kept state."""
        self._kept.pop(handle, None)
        self._submit(api.b3InitRemoveStateCommand(self.client, handle))

    def close(self) -> None:
        """End the world; harmless when repeated."""
        if self.client:
            api.b3DisconnectSharedMemory(self.client)
            self.client = 0
        self._kept.clear()

    # -- set-up --------------------------------------------------------------------

    def _submit(self, command: int) -> int:
        """Have a command done; return its status."""
        status: int = api.b3SubmitClientCommandAndWaitStatus(self.client, command)
        return status

    def _set_engine_parameters(self) -> None:
        command = api.b3InitPhysicsParamCommand(self.client)
        api.b3PhysicsParamSetTimeStep(command, CONTROL_PERIOD_S)
        api.b3PhysicsParamSetNumSubSteps(command, 0)
        api.b3PhysicsParameterSetConstraintSolverType(command, LCP_DANTZIG)
        api.b3PhysicsParamSetDefaultGlobalCFM(command, 1e-6)
        api.b3PhysicsParamSetDefaultNonContactERP(command, 0.2)
        api.b3PhysicsParamSetDefaultContactERP(command, 0.2)
        api.b3PhysicsParamSetDefaultFrictionERP(command, 0.2)
        api.b3PhysicsParameterSetDeterministicOverlappingPairs(command, 1)
        api.b3PhysicsParamSetGravity(command, 0.0, 0.0, -GRAVITY_M_S2)
        self._submit(command)

    def _make_floor(self) -> int:
        command = api.b3CreateCollisionShapeCommandInit(self.client)
        api.b3CreateCollisionShapeAddPlane(command, _doubles((0.0, 0.0, 1.0)), 0.0)
        shape = api.b3GetStatusCollisionShapeUniqueId(self._submit(command))
        command = api.b3CreateMultiBodyCommandInit(self.client)
        origin = _doubles((0.0, 0.0, 0.0)), _doubles((0.0, 0.0, 0.0, 1.0))
        no_visual, no_mass = -1, 0.0
        api.b3CreateMultiBodyBase(command, no_mass, shape, no_visual, *origin, *origin)
        floor: int = api.b3GetStatusBodyIndex(self._submit(command))
        self._take_away_losses(floor, _BASE_LINK)
        self._set_friction(floor, _BASE_LINK, 1.0)
        return floor

    def _load_robot(self, urdf: str, height_m: float) -> int:
        # The API reads files only.
        with NamedTemporaryFile(mode="w", suffix=".urdf", encoding="utf-8") as file:
            file.write(urdf)
            file.flush()
            command = api.b3LoadUrdfCommandInit(self.client, file.name.encode())
            api.b3LoadUrdfCommandSetFlags(command, USE_INERTIA_FROM_FILE)
            api.b3LoadUrdfCommandSetStartPosition(command, 0.0, 0.0, height_m)
            loaded: int = api.b3GetStatusBodyIndex(self._submit(command))
        return loaded

    def _joint_info(self, joint: int) -> Any:
        info = JointInfo()
        api.b3GetJointInfo(self.client, self.robot, joint, ctypes.addressof(info))
        return info

    def _dynamics(self, link: int) -> Array:
        """Return mass and diagonal of the inertia of a link (4,)."""
        command = api.b3GetDynamicsInfoCommandInit(self.client, self.robot, link)
        info = np.zeros(64)  # more than b3DynamicsInfo, which begins with these four
        api.b3GetDynamicsInfo(self._submit(command), info.ctypes.data)
        return info[:4]

    def _take_away_losses(self, body: int, link: int) -> None:
        command = api.b3InitChangeDynamicsInfo(self.client)
        api.b3ChangeDynamicsInfoSetLinearDamping(command, body, 0.0)
        api.b3ChangeDynamicsInfoSetAngularDamping(command, body, 0.0)
        for set_loss in (
            api.b3ChangeDynamicsInfoSetJointDamping,
            api.b3ChangeDynamicsInfoSetRollingFriction,
            api.b3ChangeDynamicsInfoSetSpinningFriction,
            api.b3ChangeDynamicsInfoSetRestitution,
        ):
            set_loss(command, body, link, 0.0)
        self._submit(command)

    def _set_friction(self, body: int, link: int, lateral: float) -> None:
        command = api.b3InitChangeDynamicsInfo(self.client)
        api.b3ChangeDynamicsInfoSetLateralFriction(command, body, link, lateral)
        self._submit(command)

    def _brake(self, u_indices: list[int], torque_nm: float) -> None:
        """Let joints' motors brake by so much; they brake by default.

        Unless told otherwise, the API has a motor take a tenth of the velocity that it
        lacks: a brake then asks for nine tenths of what there is, and drives a joint on
        that something else would stop. A walk on such brakes shakes.
        """
        command = api.b3JointControlCommandInit2(
            self.client, self.robot, VELOCITY_CONTROL
        )
        for u_index in u_indices:
            api.b3JointControlSetDesiredVelocity(command, u_index, 0.0)
            api.b3JointControlSetKd(command, u_index, 1.0)
            api.b3JointControlSetMaximumForce(command, u_index, torque_nm)
        self._submit(command)


def _doubles(values: Sequence[float]) -> Any:
    """Return numbers as a C array."""
    return (ctypes.c_double * len(values))(*values)
