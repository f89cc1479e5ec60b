"""Compiled inner loops of the kinematics: plain geometry, no checks of shapes.

Rotations are right-handed. With the torso upright, the frames of hip, knee and ankle
follow one another as

    foot = Rz(yaw) Rx(hip roll) Ry(hip pitch) Ry(knee) Ry(ankle pitch) Rx(ankle roll)

and the three pitch axes are parallel, so that their angles add.
"""

from math import acos, atan2, cos, isfinite, sin, sqrt
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from biped_common.compiled import compiled
from biped_description.joints import KNEE

Array: TypeAlias = NDArray[np.float64]
Vector: TypeAlias = tuple[float, float, float]

# Outcomes of solving the legs.
SOLVED: Final = 0
NOT_FINITE: Final = 1
UNREACHABLE: Final = 2
BEYOND_JOINT_LIMIT: Final = 3


class ChainGeometry(NamedTuple):
    """Lengths that the kinematics depends on [m]."""

    half_hip_spacing: float
    thigh_length: float
    shank_length: float
    ankle_height: float
    reach_min: float  # hip to ankle, knee flexed to its limit
    reach_max: float  # hip to ankle, knee straight
    torso_com_height: float
    thigh_com_below_hip: float
    shank_com_below_knee: float
    foot_com_below_ankle: float
    foot_com_ahead_of_ankle: float


@compiled
def solve_leg(
    dx: float, dy: float, dz: float, thigh: float, shank: float
) -> tuple[float, float, float, float, float]:
    """Return the joint angles that put the hip at (dx, dy, dz) from the ankle.

    The foot is flat, the torso upright, the yaw zero. Angles: hip roll, hip pitch,
    knee, ankle pitch, ankle roll [rad].
    """
    in_leg_plane = sqrt(dy * dy + dz * dz)
    distance_squared = dx * dx + in_leg_plane * in_leg_plane
    # Law of cosines. Rounding can carry the cosine of a straight knee past 1; the
    # caller has made sure that nothing but rounding does.
    cos_knee = (distance_squared - thigh * thigh - shank * shank) / (2 * thigh * shank)
    knee = acos(min(cos_knee, 1.0))
    # Angle at the ankle between the shank and the line to the hip.
    alpha = atan2(thigh * sin(knee), shank + thigh * cos(knee))
    # A hip ahead of its ankle, or a flexed knee, tilts the shank forward, which is a
    # negative ankle pitch; a hip to the left of its ankle is a positive ankle roll.
    ankle_roll = atan2(dy, dz)
    ankle_pitch = -atan2(dx, in_leg_plane) - alpha
    hip_pitch = -ankle_pitch - knee
    return -ankle_roll, hip_pitch, knee, ankle_pitch, ankle_roll


@compiled
def fill_leg_joint_positions(
    waist: Array,
    left_foot: Array,
    right_foot: Array,
    geometry: ChainGeometry,
    lower: Array,
    upper: Array,
    out: Array,
) -> tuple[int, int, int]:
    """Fill ``out`` (n, 12) and return (status, tick, joint)."""
    for tick in range(waist.shape[0]):
        for leg in range(2):
            foot = left_foot if leg == 0 else right_foot
            first = 6 * leg  # column of the leg's hip yaw
            hip_y = geometry.half_hip_spacing * (1 - 2 * leg)  # left +, right -
            dx = waist[tick, 0] - foot[tick, 0]
            dy = waist[tick, 1] - foot[tick, 1] + hip_y
            dz = waist[tick, 2] - foot[tick, 2] - geometry.ankle_height
            distance = sqrt(dx * dx + dy * dy + dz * dz)
            if not isfinite(distance):
                return NOT_FINITE, tick, first + KNEE
            if distance < geometry.reach_min or distance > geometry.reach_max:
                return UNREACHABLE, tick, first + KNEE
            angles = solve_leg(dx, dy, dz, geometry.thigh_length, geometry.shank_length)
            out[tick, first] = 0.0
            for joint in range(5):
                out[tick, first + 1 + joint] = angles[joint]
            for column in range(first, first + 6):
                position = out[tick, column]
                if position < lower[column] or position > upper[column]:
                    return BEYOND_JOINT_LIMIT, tick, column
    return SOLVED, -1, -1


@compiled
def fill_leg_motion(
    waist: Array,
    left_foot: Array,
    right_foot: Array,
    geometry: ChainGeometry,
    lower: Array,
    upper: Array,
    period_s: float,
    q: Array,
    dq: Array,
) -> tuple[int, int, int]:
    """Fill ``q`` (n, 12) and ``dq`` (n - 1, 12), the velocities between its rows.

    Returns (status, tick, joint); velocities from an unsolved row on are no motion.
    """
    outcome = fill_leg_joint_positions(
        waist, left_foot, right_foot, geometry, lower, upper, q
    )
    for tick in range(dq.shape[0]):
        for joint in range(dq.shape[1]):
            dq[tick, joint] = (q[tick + 1, joint] - q[tick, joint]) / period_s
    return outcome


@compiled
def leg_directions(
    yaw: float,
    hip_roll: float,
    hip_pitch: float,
    knee: float,
    ankle_pitch: float,
    ankle_roll: float,
) -> tuple[Vector, Vector, Vector, Vector, Vector]:
    """Return unit vectors of one leg in the frame of the torso.

    They are: up the thigh, up the shank, and the foot's x, y and z axes.
    """
    # Frame after yaw and roll: x axis, y axis (of the three pitch joints), z axis.
    cos_yaw, sin_yaw = cos(yaw), sin(yaw)
    cos_roll, sin_roll = cos(hip_roll), sin(hip_roll)
    x = (cos_yaw, sin_yaw, 0.0)
    y = (-sin_yaw * cos_roll, cos_yaw * cos_roll, sin_roll)
    z = (sin_yaw * sin_roll, -cos_yaw * sin_roll, cos_roll)

    # A turn by p about y carries z to x sin p + z cos p, and x to x cos p - z sin p.
    thigh_up = combine(sin(hip_pitch), x, cos(hip_pitch), z)
    shank_up = combine(sin(hip_pitch + knee), x, cos(hip_pitch + knee), z)
    pitch = hip_pitch + knee + ankle_pitch
    foot_x = combine(cos(pitch), x, -sin(pitch), z)
    ankle_up = combine(sin(pitch), x, cos(pitch), z)

    foot_y = combine(cos(ankle_roll), y, sin(ankle_roll), ankle_up)
    foot_z = combine(-sin(ankle_roll), y, cos(ankle_roll), ankle_up)
    return thigh_up, shank_up, foot_x, foot_y, foot_z


@compiled
def combine(a: float, u: Vector, b: float, v: Vector) -> Vector:
    """Return a u + b v."""
    return a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]


@compiled
def fill_foot_poses(
    q: Array, geometry: ChainGeometry, positions: Array, orientations: Array
) -> None:
    """Fill positions (2, n, 3) from the waist and orientations (2, n, 3, 3)."""
    for leg in range(2):
        hip_y = geometry.half_hip_spacing * (1 - 2 * leg)  # left +, right -
        j = 6 * leg
        for i in range(q.shape[0]):
            thigh_up, shank_up, foot_x, foot_y, foot_z = leg_directions(
                q[i, j], q[i, j + 1], q[i, j + 2], q[i, j + 3], q[i, j + 4], q[i, j + 5]
            )
            for axis in range(3):
                positions[leg, i, axis] = (
                    (hip_y if axis == 1 else 0.0)
                    - geometry.thigh_length * thigh_up[axis]
                    - geometry.shank_length * shank_up[axis]
                    - geometry.ankle_height * foot_z[axis]
                )
                orientations[leg, i, axis, 0] = foot_x[axis]
                orientations[leg, i, axis, 1] = foot_y[axis]
                orientations[leg, i, axis, 2] = foot_z[axis]


@compiled
def fill_link_coms(waist: Array, q: Array, geometry: ChainGeometry, out: Array) -> None:
    """Fill ``out`` (n, 13, 3) with the CoM of every link, order of LINK_NAMES."""
    for i in range(q.shape[0]):
        for axis in range(3):
            out[i, 0, axis] = waist[i, axis]
        out[i, 0, 2] += geometry.torso_com_height
        for leg in range(2):
            hip_y = geometry.half_hip_spacing * (1 - 2 * leg)  # left +, right -
            j = 6 * leg
            thigh_up, shank_up, foot_x, _, foot_z = leg_directions(
                q[i, j], q[i, j + 1], q[i, j + 2], q[i, j + 3], q[i, j + 4], q[i, j + 5]
            )
            thigh_com = geometry.thigh_com_below_hip
            shank_com = geometry.shank_com_below_knee
            for axis in range(3):
                hip = waist[i, axis] + (hip_y if axis == 1 else 0.0)
                knee = hip - geometry.thigh_length * thigh_up[axis]
                ankle = knee - geometry.shank_length * shank_up[axis]
                out[i, j + 1, axis] = hip  # the yaw link and the roll link
                out[i, j + 2, axis] = hip
                out[i, j + 3, axis] = hip - thigh_com * thigh_up[axis]
                out[i, j + 4, axis] = knee - shank_com * shank_up[axis]
                out[i, j + 5, axis] = ankle
                out[i, j + 6, axis] = (
                    ankle
                    + geometry.foot_com_ahead_of_ankle * foot_x[axis]
                    - geometry.foot_com_below_ankle * foot_z[axis]
                )


@compiled
def fill_weighted_mean(points: Array, weights: Array, out: Array) -> None:
    """Fill ``out`` (n, 3) with the mean of points (n, m, 3) under weights (m,)."""
    total = weights.sum()
    for i in range(points.shape[0]):
        for axis in range(3):
            moment = 0.0
            for k in range(weights.shape[0]):
                moment += weights[k] * points[i, k, axis]
            out[i, axis] = moment / total
