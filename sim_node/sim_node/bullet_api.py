"""Bullet's own C API, out of the library that PyBullet's wheel brings along.

PyBullet's Python functions are a layer on this API (PhysicsClientC_API.h). They turn
every number that is read into an object: commanding and reading the robot took a fifth
of the time of the physics step, and twice that where the processor's caches are
contended. Here the set-up goes through ctypes, and what happens in every tick through
compiled code; the physics are the same, bit for bit, as a test shows.
"""

from __future__ import annotations

import ctypes
from typing import Any, Final

import llvmlite.binding
from numba.core import types

from sim_node.quiet import engine_chatter_dropped

with engine_chatter_dropped():
    import pybullet

VELOCITY_CONTROL: Final[int] = pybullet.VELOCITY_CONTROL
POSITION_CONTROL: Final[int] = pybullet.POSITION_CONTROL
TORQUE_CONTROL: Final[int] = pybullet.TORQUE_CONTROL
JOINT_GEAR: Final[int] = pybullet.JOINT_GEAR
LCP_DANTZIG: Final[int] = pybullet.CONSTRAINT_SOLVER_LCP_DANTZIG
USE_INERTIA_FROM_FILE: Final[int] = pybullet.URDF_USE_INERTIA_FROM_FILE
WORLD_FRAME: Final[int] = pybullet.WORLD_FRAME


class JointInfo(ctypes.Structure):
    """The API's b3JointInfo."""

    _fields_ = (
        ("link_name", ctypes.c_char * 1024),
        ("joint_name", ctypes.c_char * 1024),
        ("joint_type", ctypes.c_int),
        ("q_index", ctypes.c_int),
        ("u_index", ctypes.c_int),
        ("number", ctypes.c_int),
        ("flags", ctypes.c_int),
        ("damping", ctypes.c_double),
        ("friction", ctypes.c_double),
        ("lower_limit", ctypes.c_double),
        ("upper_limit", ctypes.c_double),
        ("max_force", ctypes.c_double),
        ("max_velocity", ctypes.c_double),
        ("parent_frame", ctypes.c_double * 7),
        ("child_frame", ctypes.c_double * 7),
        ("axis", ctypes.c_double * 3),
        ("parent", ctypes.c_int),
        ("q_size", ctypes.c_int),
        ("u_size", ctypes.c_int),
    )


# Result, then arguments: p pointer or handle, i int, d double, s text, v nothing.
_SIGNATURES: Final = {
    "b3ConnectPhysicsDirect": "p",
    "b3DisconnectSharedMemory": "v p",
    "b3SubmitClientCommandAndWaitStatus": "p p p",
    # Parameters of the engine.
    "b3InitPhysicsParamCommand": "p p",
    "b3PhysicsParamSetTimeStep": "i p d",
    "b3PhysicsParamSetNumSubSteps": "i p i",
    "b3PhysicsParamSetGravity": "i p d d d",
    "b3PhysicsParamSetDefaultGlobalCFM": "i p d",
    "b3PhysicsParamSetDefaultNonContactERP": "i p d",
    "b3PhysicsParamSetDefaultContactERP": "i p d",
    "b3PhysicsParamSetDefaultFrictionERP": "i p d",
    "b3PhysicsParameterSetConstraintSolverType": "i p i",
    "b3PhysicsParameterSetDeterministicOverlappingPairs": "i p i",
    # Bodies.
    "b3CreateCollisionShapeCommandInit": "p p",
    "b3CreateCollisionShapeAddPlane": "i p p d",
    "b3GetStatusCollisionShapeUniqueId": "i p",
    "b3CreateMultiBodyCommandInit": "p p",
    "b3CreateMultiBodyBase": "i p d i i p p p p",
    "b3LoadUrdfCommandInit": "p p s",
    "b3LoadUrdfCommandSetFlags": "i p i",
    "b3LoadUrdfCommandSetStartPosition": "i p d d d",
    "b3GetStatusBodyIndex": "i p",
    "b3GetJointInfo": "i p i i p",
    # Masses, damping and friction.
    "b3GetDynamicsInfoCommandInit": "p p i i",
    "b3GetDynamicsInfo": "i p p",
    "b3InitChangeDynamicsInfo": "p p",
    "b3ChangeDynamicsInfoSetMass": "i p i i d",
    "b3ChangeDynamicsInfoSetLocalInertiaDiagonal": "i p i i p",
    "b3ChangeDynamicsInfoSetLateralFriction": "i p i i d",
    "b3ChangeDynamicsInfoSetRollingFriction": "i p i i d",
    "b3ChangeDynamicsInfoSetSpinningFriction": "i p i i d",
    "b3ChangeDynamicsInfoSetRestitution": "i p i i d",
    "b3ChangeDynamicsInfoSetJointDamping": "i p i i d",
    "b3ChangeDynamicsInfoSetMaxJointVelocity": "i p i d",
    "b3ChangeDynamicsInfoSetLinearDamping": "i p i d",
    "b3ChangeDynamicsInfoSetAngularDamping": "i p i d",
    # Gears.
    "b3InitCreateUserConstraintCommand": "p p i i i i p",
    "b3GetStatusUserConstraintUniqueId": "i p",
    "b3InitChangeUserConstraintCommand": "p p i",
    "b3InitChangeUserConstraintSetGearRatio": "i p d",
    "b3InitChangeUserConstraintSetMaxForce": "i p d",
    "b3InitChangeUserConstraintSetERP": "i p d",
    # Poses.
    "b3CreatePoseCommandInit": "p p i",
    "b3CreatePoseCommandSetBasePosition": "i p d d d",
    "b3CreatePoseCommandSetBaseOrientation": "i p d d d d",
    "b3CreatePoseCommandSetBaseLinearVelocity": "i p p",
    "b3CreatePoseCommandSetBaseAngularVelocity": "i p p",
    "b3CreatePoseCommandSetJointPosition": "i p p i d",
    "b3CreatePoseCommandSetJointVelocity": "i p p i d",
    # States.
    "b3SaveStateCommandInit": "p p",
    "b3GetStatusGetStateId": "i p",
    "b3LoadStateCommandInit": "p p",
    "b3LoadStateSetStateId": "i p i",
    "b3InitRemoveStateCommand": "p p i",
    # Motion.
    "b3JointControlCommandInit2": "p p i i",
    "b3JointControlSetDesiredPosition": "i p i d",
    "b3JointControlSetDesiredVelocity": "i p i d",
    "b3JointControlSetKp": "i p i d",
    "b3JointControlSetKd": "i p i d",
    "b3JointControlSetMaximumForce": "i p i d",
    "b3JointControlSetDesiredForceTorque": "i p i d",
    "b3ApplyExternalForceCommandInit": "p p",
    "b3ApplyExternalForce": "v p i i p p i",
    "b3InitStepSimulationCommand": "p p",
    # Readings.
    "b3RequestActualStateCommandInit": "p p i",
    "b3GetStatusActualState": "i p p p p p p p p",
    "b3GetJointState": "i p p i p",
    "b3RotateVector": "v p p p",
    "b3InitRequestContactPointInformation": "p p",
    "b3SetContactFilterBodyA": "v p i",
    "b3SetContactFilterBodyB": "v p i",
    "b3GetContactPointInformation": "v p p",
}
_CTYPES: Final = {
    "p": ctypes.c_void_p,
    "i": ctypes.c_int,
    "d": ctypes.c_double,
    "s": ctypes.c_char_p,
    "v": None,
}
_COMPILED: Final[dict[str, Any]] = {
    "p": types.intp,
    "i": types.int32,
    "d": types.float64,
    "v": types.void,
}


def declared(path: str) -> Any:
    """Return a library with the functions of the API declared.

    Raises:
        ImportError: it does not export one of them.
    """
    library = ctypes.CDLL(path)
    for name, letters in _SIGNATURES.items():
        try:
            function = getattr(library, name)
        except AttributeError:
            raise ImportError(f"{path} does not export {name}") from None
        function.restype, *function.argtypes = (_CTYPES[c] for c in letters.split())
        # Compiled code finds the function by its name. The names of the library as a
        # whole must stay its own: it brings another tinyxml2 than the middleware's.
        address = ctypes.cast(function, ctypes.c_void_p).value
        llvmlite.binding.add_symbol(name, address)
    return library


api: Final = declared(pybullet.__file__)
"""The API for Python; a pointer is an address, such as that of a numpy array."""


def compiled_api(name: str, letters: str = "") -> Any:
    """Return a function for compiled code; one that is not in the API needs letters."""
    result, *arguments = (_COMPILED[c] for c in (letters or _SIGNATURES[name]).split())
    return types.ExternalFunction(name, result(*arguments))
