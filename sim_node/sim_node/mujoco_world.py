"""Full physics by MuJoCo: a floor and the biped, with servos as constraints.

A servo is an equality constraint on its joint: it asks for the velocity that brings the
joint to its next reference, and is solved together with the contacts. Where this takes
more than the servo has, the tick is solved again with that joint driven by its limit.
"""

from __future__ import annotations

import itertools
import xml.etree.ElementTree as ET
from typing import Final

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

_N_JOINTS: Final = len(JOINT_NAMES)
_FREE_Q, _FREE_V = 7, 6
"""Positions and velocities of the torso come first."""
_KEPT: Final = int(mujoco.mjtState.mjSTATE_INTEGRATION)
# The share of a position error that a servo takes away in a tick, as Bullet's do.
_POSITION_GAIN: Final = 0.1
# A constraint gives way by one part in so many; MuJoCo's are never quite stiff.
_STIFF: Final = (0.9999, 0.9999, 0.001, 0.5, 2.0)
_CONTACT = (0.98, 0.99, 0.001, 0.5, 2.0)
_CONTACT_TIME_S, _CONTACT_DAMPING = 0.004, 1.0
"""Chosen on the static walk without limit, next to Bullet: ZMPs 3.2 mm apart (root mean
square), 23 of 5,625 ticks more than 15 mm, all of them when a foot touches down. Softer,
soles sink and feet touch down early; stiffer, contacts and servos fight each other in
double support, and the ZMP chatters."""


class MuJoCoWorld(Physics):
    """Floor and robot; see `Physics`."""

    def __init__(self, robot: Robot, friction: float, torque_limits_nm: Array) -> None:
        """Build the model, with the robot standing at the origin."""
        self._model = _model(robot, friction)
        self._data = mujoco.MjData(self._model)
        self._torque_limits_nm = torque_limits_nm
        model = self._model
        self._torso = model.body(TORSO).id
        links = [model.body(name).id for name in LINK_NAMES]
        self._links = np.array(links)
        self._left_sole = int(model.body_geomadr[model.body(CONTACT_LINKS[0]).id])
        dofs = [model.joint(name).dofadr[0] for name in JOINT_NAMES]
        self._dofs = np.array(dofs)
        self._positions = self._dofs + (_FREE_Q - _FREE_V)
        self._servos = np.array([model.equality(name).id for name in JOINT_NAMES])
        self._mass = model.body_mass[self._links].copy()
        self._inertia = model.body_inertia[self._links].copy()
        self._handles = itertools.count()
        self._kept: dict[int, Array] = {}
        self._state = np.empty(mujoco.mj_stateSize(model, _KEPT))

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
        # MuJoCo wants the acceleration  -b v - k (q - aim);  with b = 1 / dt it brings
        # the velocity to k dt (aim - q), which is to be dq + gain (q_ref - q) / dt.
        model.eq_data[self._servos, 0] = q + dq * (CONTROL_PERIOD_S / _POSITION_GAIN)
        torques = self._solved()
        limits = self._torque_limits_nm
        over = np.abs(torques) > limits
        if over.any():
            data.eq_active[self._servos] = ~over
            applied = np.where(over, np.copysign(limits, torques), 0.0)
            data.qfrc_applied[self._dofs] = applied
            torques = self._solved() + applied
        mujoco.mj_Euler(model, data)
        if over.any():
            data.eq_active[self._servos] = 1
            data.qfrc_applied[self._dofs] = 0.0
        data.xfrc_applied[self._torso, :3] = 0.0
        joints[:_N_JOINTS] = data.qpos[self._positions]
        joints[_N_JOINTS : 2 * _N_JOINTS] = data.qvel[self._dofs]
        joints[2 * _N_JOINTS :] = torques
        return self._contact()

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
        handle = next(self._handles)
        mujoco.mj_getState(self._model, self._data, self._state, _KEPT)
        self._kept[handle] = self._state.copy()
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

    def _solved(self) -> Array:
        """Solve the tick; return the torques of the servos (12,)."""
        model, data = self._model, self._data
        mujoco.mj_forward(model, data)
        torques = np.zeros(_N_JOINTS)
        servos = data.efc_id[: data.ne] - self._servos[0]
        torques[servos] = data.efc_force[: data.ne]
        return torques

    def _contact(self) -> FloorContact:
        data = self._data
        if not data.ncon:
            return FloorContact(0.0, 0.0, 0.0, 0.0, 0.0)
        contact = data.contact
        touching = contact.efc_address >= 0
        forces = np.zeros(data.ncon)
        forces[touching] = data.efc_force[contact.efc_address[touching]]
        load = float(forces.sum())
        left = float(forces[contact.geom[:, 1] == self._left_sole].sum())
        penetration = max(0.0, -float(contact.dist.min()))
        if not load > 0.0:
            return FloorContact(0.0, 0.0, 0.0, 0.0, penetration)
        x, y, _ = (forces @ contact.pos / load).tolist()
        return FloorContact(x, y, left, load - left, penetration)


def _model(robot: Robot, friction: float) -> mujoco.MjModel:
    """Return floor and robot as MuJoCo compiles them."""
    urdf = ET.fromstring(robot.urdf)
    extension = ET.SubElement(urdf, "mujoco")
    ET.SubElement(
        extension, "compiler", fusestatic="false", discardvisual="true",
        balanceinertia="false",
    )  # fmt: skip
    spec = mujoco.MjSpec.from_string(ET.tostring(urdf, encoding="unicode"))
    options = spec.option
    options.timestep = CONTROL_PERIOD_S
    options.gravity = (0.0, 0.0, -GRAVITY_M_S2)
    options.integrator = mujoco.mjtIntegrator.mjINT_EULER
    options.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    options.solver = mujoco.mjtSolver.mjSOL_NEWTON
    options.disableflags |= (
        mujoco.mjtDisableBit.mjDSBL_REFSAFE
        | mujoco.mjtDisableBit.mjDSBL_EULERDAMP
        | mujoco.mjtDisableBit.mjDSBL_LIMIT
    )
    spec.body(TORSO).add_freejoint()
    contact = {
        "friction": (friction, 0.0, 0.0),
        "solref": (_CONTACT_TIME_S, _CONTACT_DAMPING),
        "solimp": _CONTACT,
        "condim": 3,
    }
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0.0, 0.0, 1.0), **contact
    )
    for name in CONTACT_LINKS:
        for geom in spec.body(name).geoms:
            geom.friction, geom.condim = contact["friction"], 3
            geom.solref, geom.solimp = contact["solref"], _CONTACT
            geom.contype, geom.conaffinity = 2, 1  # with the floor only
    for name in JOINT_NAMES:
        servo = spec.add_equality(
            name=name, type=mujoco.mjtEq.mjEQ_JOINT, name1=name,
            objtype=mujoco.mjtObj.mjOBJ_JOINT,
        )  # fmt: skip
        dt = CONTROL_PERIOD_S
        servo.solref = (-_POSITION_GAIN / dt**2, -1.0 / dt)
        servo.solimp = _STIFF
    return spec.compile()
