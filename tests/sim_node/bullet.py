"""Hands on the robot in a Bullet world: what no walk does, by the same C API."""

import ctypes

import numpy as np
from tests.robots import SHIPPED

from sim_node.bullet_api import api
from sim_node.bullet_kernels import read_base
from sim_node.pybullet_world import PyBulletWorld

LINKS = range(-1, 12)  # the torso is -1
UPRIGHT = (0.0, 0.0, 0.0, 1.0)
FRICTION = 11  # among what `dynamics` returns

api.b3RequestActualStateCommandComputeLinkVelocity.argtypes = (
    ctypes.c_void_p,
    ctypes.c_int,
)
api.b3GetLinkState.argtypes = (
    ctypes.c_void_p,
    ctypes.c_void_p,
    ctypes.c_int,
    ctypes.c_void_p,
)


def base_position(world: PyBulletWorld) -> np.ndarray:
    """Return where the torso's CoM is (3,) [m]."""
    base = np.empty(13)
    read_base(world.client, world.robot, base)
    return base[:3]


def put_base(world: PyBulletWorld, position, orientation=UPRIGHT) -> None:
    """Put the torso's CoM somewhere [m], turned by a quaternion (x, y, z, w)."""
    command = api.b3CreatePoseCommandInit(world.client, world.robot)
    api.b3CreatePoseCommandSetBasePosition(command, *position)
    api.b3CreatePoseCommandSetBaseOrientation(command, *orientation)
    api.b3SubmitClientCommandAndWaitStatus(world.client, command)


def raise_robot(world: PyBulletWorld, height_m: float) -> None:
    """Lift the robot off the floor, or press it down."""
    put_base(world, base_position(world) + np.array([0.0, 0.0, height_m]))


def throw_base(world: PyBulletWorld, velocity, spin=None) -> None:
    """Give the torso a velocity [m/s], and a spin [rad/s] if asked for."""
    command = api.b3CreatePoseCommandInit(world.client, world.robot)
    linear = np.array(velocity)
    api.b3CreatePoseCommandSetBaseLinearVelocity(command, linear.ctypes.data)
    if spin is not None:
        angular = np.array(spin)
        api.b3CreatePoseCommandSetBaseAngularVelocity(command, angular.ctypes.data)
    api.b3SubmitClientCommandAndWaitStatus(world.client, command)


def put_joint(
    world: PyBulletWorld, joint: int, position: float, velocity: float
) -> None:
    """Put a joint somewhere [rad], and turn it [rad/s]."""
    command = api.b3CreatePoseCommandInit(world.client, world.robot)
    of_joint = world.client, command, int(world.joint_numbers[0, joint])
    api.b3CreatePoseCommandSetJointPosition(*of_joint, position)
    api.b3CreatePoseCommandSetJointVelocity(*of_joint, velocity)
    api.b3SubmitClientCommandAndWaitStatus(world.client, command)


def dynamics(world: PyBulletWorld, link: int) -> np.ndarray:
    """Return mass [kg], inertia (3) [kg m^2], inertial frame (7) and friction (12,)."""
    info = np.zeros(64)
    command = api.b3GetDynamicsInfoCommandInit(world.client, world.robot, link)
    status = api.b3SubmitClientCommandAndWaitStatus(world.client, command)
    api.b3GetDynamicsInfo(status, info.ctypes.data)
    return info[:12]


def link_com(world: PyBulletWorld, link: int) -> tuple[np.ndarray, np.ndarray]:
    """Return position [m] and velocity [m/s] of a link's CoM."""
    command = api.b3RequestActualStateCommandInit(world.client, world.robot)
    api.b3RequestActualStateCommandComputeLinkVelocity(command, 1)
    status = api.b3SubmitClientCommandAndWaitStatus(world.client, command)
    state = np.zeros(64)
    api.b3GetLinkState(world.client, status, link, state.ctypes.data)
    return state[:3], state[21:24]


def momentum(world: PyBulletWorld) -> np.ndarray:
    """Return the (3,) linear momentum of all links of the shipped robot [kg m/s]."""
    base = np.empty(13)
    read_base(world.client, world.robot, base)
    links = [link_com(world, link)[1] for link in LINKS[1:]]
    return SHIPPED.link_masses_kg @ np.array([base[7:10], *links])
