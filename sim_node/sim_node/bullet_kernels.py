"""What is asked of a Bullet world in every control tick, compiled.

The functions call the C API by name. As a handle of a world they take its client; the
bodies and joints are the API's numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

from biped_description.joints import JOINT_NAMES
from sim_node.bullet_api import POSITION_CONTROL, TORQUE_CONTROL, compiled_api

_N_JOINTS = len(JOINT_NAMES)
# Rows of the joints' numbers: in the API, among positions, among velocities.
NUMBER, Q_INDEX, U_INDEX = range(3)

_submit = compiled_api("b3SubmitClientCommandAndWaitStatus")
_init_control = compiled_api("b3JointControlCommandInit2")
_set_position = compiled_api("b3JointControlSetDesiredPosition")
_set_velocity = compiled_api("b3JointControlSetDesiredVelocity")
_set_position_gain = compiled_api("b3JointControlSetKp")
_set_velocity_gain = compiled_api("b3JointControlSetKd")
_set_force = compiled_api("b3JointControlSetMaximumForce")
_set_torque = compiled_api("b3JointControlSetDesiredForceTorque")
_init_step = compiled_api("b3InitStepSimulationCommand")
_request_state = compiled_api("b3RequestActualStateCommandInit")
_get_state = compiled_api("b3GetStatusActualState")
_get_joint_state = compiled_api("b3GetJointState")
_rotate = compiled_api("b3RotateVector")
_request_contact = compiled_api("b3InitRequestContactPointInformation")
_filter_a = compiled_api("b3SetContactFilterBodyA")
_filter_b = compiled_api("b3SetContactFilterBodyB")
_get_contact = compiled_api("b3GetContactPointInformation")
_copy = compiled_api("memcpy", "p p p p")

# b3JointSensorState: position, velocity, six reaction forces, torque of the motor.
_STATE_SIZE, _STATE_TORQUE = 9, 8
# b3ContactPointData in doubles: five ints (flags, bodies, links) and padding, points on
# A and B, normal on B, distance, normal force and more.
POINT_SIZE, POINT_ON_B, DISTANCE, NORMAL_FORCE = 22, 6, 12, 13
LINK_A = 3  # among the ints
_DOUBLE = 8  # [bytes]


@njit(cache=True)
def command_servos(
    client: int,
    robot: int,
    numbers: Any,
    torque_limits: Any,
    shares: Any,
    q: Any,
    dq: Any,
) -> None:
    """Give the servos their references for the next tick.

    Args:
        client: of the world.
        robot: its body.
        numbers: (3, 12) of the joints.
        torque_limits: (12,) [N m]
        shares: (2,) of its errors that a servo takes back, as in `ServoShares`.
        q: (12,) positions now [rad].
        dq: (12,) velocities until the next tick [rad/s].
    """
    message = _init_control(client, robot, POSITION_CONTROL)
    for i in range(_N_JOINTS):
        u_index = numbers[U_INDEX, i]
        _set_position(message, numbers[Q_INDEX, i], q[i])
        _set_position_gain(message, u_index, shares[0])
        _set_velocity(message, u_index, dq[i])
        _set_velocity_gain(message, u_index, shares[1])
        _set_force(message, u_index, torque_limits[i])
    _submit(client, message)


@njit(cache=True)
def pull_joints(client: int, robot: int, numbers: Any, torques: Any) -> None:
    """Pull at the joints during the next tick by `torques` (12,) [N m]."""
    message = _init_control(client, robot, TORQUE_CONTROL)
    for i in range(_N_JOINTS):
        _set_torque(message, numbers[U_INDEX, i], torques[i])
    _submit(client, message)


@njit(cache=True)
def step_physics(client: int) -> None:
    """Go on by one control tick."""
    _submit(client, _init_step(client))


@njit(cache=True)
def read_joints(client: int, robot: int, numbers: Any, joints: Any) -> None:
    """Fill `joints` (36,) with positions, velocities and torques."""
    status = _submit(client, _request_state(client, robot))
    state = np.empty(_STATE_SIZE)
    for i in range(_N_JOINTS):
        _get_joint_state(client, status, numbers[NUMBER, i], state.ctypes.data)
        joints[i] = state[0]
        joints[_N_JOINTS + i] = state[1]
        joints[2 * _N_JOINTS + i] = state[_STATE_TORQUE]


@njit(cache=True)
def contact_points(client: int, robot: int, floor: int) -> Any:
    """Return the (n, 22) contact points of the robot, body A, with the floor."""
    message = _request_contact(client)
    _filter_a(message, robot)
    _filter_b(message, floor)
    _submit(client, message)
    found = np.empty(2, np.int64)  # b3ContactInformation: number, address
    _get_contact(client, found.ctypes.data)
    points = np.empty((found.view(np.int32)[0], POINT_SIZE))
    _copy(points.ctypes.data, found[1], points.nbytes)
    return points


@njit(cache=True)
def sum_contact(
    points: Any, left_sole: int
) -> tuple[float, float, float, float, float]:
    """Sum up contact points: ZMP = sum(f p) / sum(f) over pressing points.

    Args:
        points: (n, 22) as the API lays them out.
        left_sole: number of the left foot; what else touches is the right one.

    Returns:
        The numbers of a `FloorContact`.
    """
    ints = points.view(np.int32)
    left = right = moment_x = moment_y = nearest = 0.0
    for i in range(len(points)):
        force = points[i, NORMAL_FORCE]
        if points[i, DISTANCE] < nearest:
            nearest = points[i, DISTANCE]
        if force > 0.0:
            moment_x += force * points[i, POINT_ON_B]
            moment_y += force * points[i, POINT_ON_B + 1]
            if ints[i, LINK_A] == left_sole:
                left += force
            else:
                right += force
    load = left + right
    if load > 0.0:
        return moment_x / load, moment_y / load, left, right, -nearest
    return 0.0, 0.0, 0.0, 0.0, -nearest


@njit(cache=True)
def step_and_read(
    client: int, robot: int, floor: int, left_sole: int, numbers: Any, joints: Any
) -> tuple[float, float, float, float, float]:
    """Go on by one control tick, and read the sensors."""
    step_physics(client)
    read_joints(client, robot, numbers, joints)
    return sum_contact(contact_points(client, robot, floor), left_sole)


@njit(cache=True)
def tick(
    client: int,
    robot: int,
    floor: int,
    left_sole: int,
    numbers: Any,
    torque_limits: Any,
    shares: Any,
    q: Any,
    dq: Any,
    joints: Any,
) -> tuple[float, float, float, float, float]:
    """Command, step and read; see `Physics.step`."""
    command_servos(client, robot, numbers, torque_limits, shares, q, dq)
    return step_and_read(client, robot, floor, left_sole, numbers, joints)


@njit(cache=True)
def pulled_tick(
    client: int,
    robot: int,
    floor: int,
    left_sole: int,
    numbers: Any,
    torques: Any,
    joints: Any,
) -> tuple[float, float, float, float, float]:
    """Pull, step and read; see `Physics.step`.

    The torques that are read are the (12,) ones pulled by [N m].
    """
    pull_joints(client, robot, numbers, torques)
    contact = step_and_read(client, robot, floor, left_sole, numbers, joints)
    joints[2 * _N_JOINTS :] = torques
    return contact


@njit(cache=True)
def read_base(client: int, robot: int, base: Any) -> None:
    """Fill `base` (13,): position of the torso's CoM, quaternion, velocity, spin."""
    status = _submit(client, _request_state(client, robot))
    addresses = np.empty(2, np.int64)
    first = addresses.ctypes.data
    _get_state(status, 0, 0, 0, 0, first, first + _DOUBLE, 0)
    _copy(base.ctypes.data, addresses[0], 7 * _DOUBLE)
    _copy(base.ctypes.data + 7 * _DOUBLE, addresses[1], 6 * _DOUBLE)


@njit(cache=True)
def waist_state(
    client: int, robot: int, torso_com_height: float
) -> tuple[float, float, float, float, float, float]:
    """Return position and velocity of the waist.

    The API speaks of the torso's CoM; the waist lies below it.
    """
    base, down, from_com = np.empty(13), np.zeros(3), np.empty(3)
    read_base(client, robot, base)
    down[2] = -torso_com_height
    _rotate(base.ctypes.data + 3 * _DOUBLE, down.ctypes.data, from_com.ctypes.data)
    dx, dy, dz = from_com[0], from_com[1], from_com[2]
    wx, wy, wz = base[10], base[11], base[12]
    return (
        base[0] + dx,
        base[1] + dy,
        base[2] + dz,
        base[7] + (wy * dz - wz * dy),
        base[8] + (wz * dx - wx * dz),
        base[9] + (wx * dy - wy * dx),
    )
