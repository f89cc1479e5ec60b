"""Full physics by MuJoCo: a floor and the biped.

A constraint of MuJoCo's asks for an acceleration, and gets the nearest that there is.
Servos and soles ask here for what they ask for in the Bullet world: the velocity that
leads to the next reference, by no more than the torque limit, and none into the floor.
"""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from typing import Any, Final

import mujoco
import numpy as np

from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from biped_description.links import CONTACT_LINKS, LINK_NAMES, TORSO
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from sim_node.contact import FloorContact
from sim_node.errors import SnapshotError
from sim_node.physics import Array, Physics, Vector, WaistState
from sim_node.servo import IDEAL_SERVO, PidServos, ServoSettings

_N_JOINTS: Final = len(JOINT_NAMES)
_KEPT: Final = int(mujoco.mjtState.mjSTATE_INTEGRATION)
_PENETRATION_SHARE: Final = 0.2
"""Of it that is taken back in a tick, as in the Bullet world."""
_NEAR_M: Final = 5e-3
"""A corner of a sole that is no higher is kept from entering the floor. MuJoCo's own
contact acts on what has entered: feet land by impacts, and unloaded corners rattle."""
# Constraints give way by one part in 10,000, the least there is, and in 1,000.
_SERVO_IMPEDANCE, _CONTACT_IMPEDANCE = 0.9999, 0.999


class MuJoCoWorld(Physics):
    """Floor and robot; see `Physics`."""

    def __init__(
        self,
        robot: Robot,
        friction: float,
        torque_limits_nm: Array,
        servo: ServoSettings = IDEAL_SERVO,
    ) -> None:
        """Build the model, with the robot standing at the origin."""
        self._model = model = _model(robot, friction)
        self._data = mujoco.MjData(model)
        self._torso = model.body(TORSO).id
        self._links = np.array([model.body(name).id for name in LINK_NAMES])
        self._left_sole = int(model.body_geomadr[model.body(CONTACT_LINKS[0]).id])
        joints = [model.joint(name) for name in JOINT_NAMES]
        self._positions = np.array([joint.qposadr[0] for joint in joints])
        self._dofs = np.array([joint.dofadr[0] for joint in joints])
        self._pid: PidServos | None = None
        if servo.kind == "pid":
            # The state of the engine keeps what the servos remember.
            remembered = self._data.userdata.reshape(2, _N_JOINTS)
            self._pid = PidServos(servo, torque_limits_nm, remembered)
            model.dof_frictionloss[self._dofs] = servo.friction_nm
            model.dof_armature[self._dofs] = servo.rotor_inertia_kg_m2
            mujoco.mj_setConst(model, mujoco.MjData(model))
        else:
            self._shares = servo.shares
            # Dry friction that brakes towards a velocity of its own.
            model.dof_frictionloss[self._dofs] = torque_limits_nm
        self._mass = model.body_mass[self._links].copy()
        self._inertia = model.body_inertia[self._links].copy()
        self._handles = itertools.count()
        self._kept: dict[int, Array] = {}
        self._state_size = mujoco.mj_stateSize(model, _KEPT)

    def set_mass_factors(self, factors: Array) -> None:
        """Scale the nominal mass and inertia of the (13,) links."""
        self._model.body_mass[self._links] = self._mass * factors
        self._model.body_inertia[self._links] = self._inertia * factors[:, None]
        mujoco.mj_setConst(self._model, mujoco.MjData(self._model))

    # -- motion --------------------------------------------------------------------

    def place(self, waist: Array, q: Array) -> None:
        """Put the robot at rest, upright, with its waist and joints as given."""
        data = self._data
        mujoco.mj_resetData(self._model, data)
        data.qpos[:3], data.qpos[3:7] = waist, (1.0, 0.0, 0.0, 0.0)
        data.qpos[self._positions] = q

    def push(self, force_n: Vector) -> None:
        """Push the torso at its CoM during the next control tick."""
        self._data.xfrc_applied[self._torso, :3] = force_n

    def step(self, q: Array, dq: Array, joints: Array) -> FloorContact:
        """Drive the joints for one control tick, and read the sensors."""
        model, data = self._model, self._data
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        if self._pid:
            position_error = q - data.qpos[self._positions]
            velocity_error = dq - data.qvel[self._dofs]
            pulled = self._pid.pull(position_error, velocity_error)
            data.qfrc_applied[self._dofs] = pulled
        servos = self._ask_servos(q, dq)
        normals = self._ask_soles()
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        mujoco.mj_fwdConstraint(model, data)
        mujoco.mj_Euler(model, data)
        data.xfrc_applied[self._torso] = 0.0
        torques = data.qfrc_applied.copy()
        if not self._pid:
            torques[data.efc_id[servos]] = data.efc_force[servos]
        joints[:_N_JOINTS] = data.qpos[self._positions]
        joints[_N_JOINTS : 2 * _N_JOINTS] = data.qvel[self._dofs]
        joints[2 * _N_JOINTS :] = torques[self._dofs]
        return self._floor_contact(data.efc_force[normals])

    # -- readings ------------------------------------------------------------------

    def waist(self) -> WaistState:
        """Return where the waist is and how it moves."""
        x, y, z = self._data.qpos[:3].tolist()
        vx, vy, vz = self._data.qvel[:3].tolist()
        return WaistState((x, y, z), (vx, vy, vz))

    def torso_orientation(self) -> tuple[float, float, float, float]:
        """Return the torso's orientation, a quaternion (x, y, z, w)."""
        w, x, y, z = self._data.qpos[3:7].tolist()
        return x, y, z, w

    # -- states --------------------------------------------------------------------

    def save(self) -> int:
        """Keep the present state in memory; return its handle."""
        handle, state = next(self._handles), np.empty(self._state_size)
        mujoco.mj_getState(self._model, self._data, state, _KEPT)
        self._kept[handle] = state
        return handle

    def load(self, handle: int) -> None:
        """Go back to a kept state, bit for bit."""
        if handle not in self._kept:
            raise SnapshotError(f"state {handle} is not kept by this world")
        mujoco.mj_setState(self._model, self._data, self._kept[handle], _KEPT)

    def release(self, handle: int) -> None:
        """Forget a kept state."""
        self._kept.pop(handle, None)

    def close(self) -> None:
        """Forget all kept states."""
        self._kept.clear()

    # -- servos and soles ----------------------------------------------------------

    def _ask_servos(self, q: Array, dq: Array) -> slice:
        """Ask for the velocities that lead to the next references, or for standstill.

        Servos lead somewhere; the gears of PID servos only brake. One without torque or
        friction has no row.

        Returns:
            The rows.
        """
        data = self._data
        asked = np.zeros(self._model.nv)
        if not self._pid:
            position, velocity = self._shares
            error, now = q - data.qpos[self._positions], data.qvel[self._dofs]
            asked[self._dofs] = velocity * dq + (1.0 - velocity) * now
            asked[self._dofs] += position / CONTROL_PERIOD_S * error
        rows = slice(data.nf)
        missing = (asked - data.qvel)[data.efc_id[rows]]
        data.efc_aref[rows] = missing / CONTROL_PERIOD_S
        return rows

    def _ask_soles(self) -> Any:
        """Ask for velocities that keep soles from slipping and from entering the floor.

        Returns:
            The row of each contact point's normal; two along the floor follow it.
        """
        data = self._data
        first, normals = data.nf, data.contact.efc_address
        height = data.contact.dist
        missing = -data.efc_vel[first : data.nefc]
        share = np.where(height > 0.0, 1.0, _PENETRATION_SHARE)
        missing[normals - first] -= share * height / CONTROL_PERIOD_S
        data.efc_aref[first : data.nefc] = missing / CONTROL_PERIOD_S
        return normals

    def _floor_contact(self, forces_n: Array) -> FloorContact:
        """Sum up contact points: ZMP = sum(f p) / sum(f)."""
        contact = self._data.contact
        penetration = max(0.0, -float(contact.dist.min(initial=0.0)))
        load = float(forces_n.sum())
        if not load > 0.0:
            return FloorContact(0.0, 0.0, 0.0, 0.0, penetration)
        left = float(forces_n[contact.geom[:, 1] == self._left_sole].sum())
        x, y, _ = (forces_n @ contact.pos / load).tolist()
        return FloorContact(x, y, left, load - left, penetration)


def _model(robot: Robot, friction: float) -> mujoco.MjModel:
    """Return floor and robot as MuJoCo compiles them."""
    urdf = ET.fromstring(robot.urdf)
    compiler = {"fusestatic": "false", "discardvisual": "true"}
    ET.SubElement(ET.SubElement(urdf, "mujoco"), "compiler", compiler)
    spec = mujoco.MjSpec.from_string(ET.tostring(urdf, encoding="unicode"))
    options = spec.option
    options.timestep = CONTROL_PERIOD_S
    options.gravity = (0.0, 0.0, -GRAVITY_M_S2)
    options.integrator = mujoco.mjtIntegrator.mjINT_EULER
    options.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    options.solver = mujoco.mjtSolver.mjSOL_NEWTON
    options.tolerance = 1e-14
    # The robot's own limits of motion end a walk; no joint has a stop.
    options.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    spec.nuserdata = 2 * _N_JOINTS  # of PID servos
    spec.body(TORSO).add_freejoint()
    floor = spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0.0, 0.0, 1.0)
    )
    soles = [geom for name in CONTACT_LINKS for geom in spec.body(name).geoms]
    for geom in (floor, *soles):
        geom.friction, geom.condim = (friction, 0.0, 0.0), 3
        geom.solimp[:2] = _CONTACT_IMPEDANCE
        geom.margin = _NEAR_M / 2.0  # of two geoms, margins add up
    for sole in soles:
        sole.contype, sole.conaffinity = 2, 1  # meets the floor only
    for name in JOINT_NAMES:
        joint = spec.joint(name)
        joint.solimp_friction[:2] = _SERVO_IMPEDANCE
    return spec.compile()
