"""Kinematics of the biped with an upright torso, over many control ticks at once.

Every array has one row per control tick. Positions are in the world frame [m] unless
the text says otherwise, joint positions in the order of ``JOINT_NAMES`` [rad].
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from biped_description import kernels
from biped_description.dimensions import BIPED, Biped
from biped_description.errors import (
    DescriptionError,
    InvalidInputError,
    JointLimitError,
    UnreachablePoseError,
)
from biped_description.joints import (
    JOINT_NAMES,
    JOINTS_PER_LEG,
    KNEE,
    LEG_JOINTS,
    LEGS,
    POSITION_LOWER,
    POSITION_UPPER,
)
from biped_description.kernels import (
    BEYOND_JOINT_LIMIT,
    NOT_FINITE,
    SOLVED,
    UNREACHABLE,
    Array,
    ChainGeometry,
)
from biped_description.links import LINK_MASSES, LINK_NAMES

__all__ = [
    "BEYOND_JOINT_LIMIT",
    "GEOMETRY",
    "LINK_MASSES",
    "LINK_NAMES",
    "NOT_FINITE",
    "SOLVED",
    "UNREACHABLE",
    "com_position",
    "foot_orientations",
    "leg_joint_positions",
    "link_com_positions",
    "solve_error",
    "solve_legs",
    "waist_to_feet",
]

# Slack by which a stretched leg, a legal pose, may seem too long [m].
_ROUNDING: Final = 1e-12


def _span(biped: Biped, knee: float) -> float:
    """Return the distance from hip to ankle at a knee position [m]."""
    a, b = biped.thigh_length, biped.shank_length
    return float(np.sqrt(a * a + b * b + 2 * a * b * np.cos(knee)))


def chain_geometry(biped: Biped) -> ChainGeometry:
    """Collect the lengths that the kinematics depends on."""
    return ChainGeometry(
        half_hip_spacing=biped.half_hip_spacing,
        thigh_length=biped.thigh_length,
        shank_length=biped.shank_length,
        ankle_height=biped.ankle_height,
        reach_min=_span(biped, LEG_JOINTS[KNEE].position_upper),
        reach_max=_span(biped, LEG_JOINTS[KNEE].position_lower) + _ROUNDING,
        torso_com_height=biped.torso_com_height,
        thigh_com_below_hip=biped.thigh_com_below_hip,
        shank_com_below_knee=biped.shank_com_below_knee,
        foot_com_below_ankle=biped.foot_com_below_ankle,
        foot_com_ahead_of_ankle=biped.sole_ahead_of_ankle,
    )


# All lengths [m], for callers that run the kernels from compiled code of their own.
GEOMETRY: Final = chain_geometry(BIPED)


def leg_joint_positions(
    waist: ArrayLike, left_foot: ArrayLike, right_foot: ArrayLike
) -> Array:
    """Return the joint positions (n, 12) that reach the given waist and feet.

    The torso is upright, the feet are flat and the yaw joints are at zero.

    Args:
        waist: (n, 3) midpoint of the hip line.
        left_foot: (n, 3) point of the left sole under the ankle.
        right_foot: (n, 3) point of the right sole under the ankle.

    Raises:
        InvalidInputError: a shape is wrong, or a number is NaN or infinite.
        UnreachablePoseError: a hip is too near its ankle or too far from it.
        JointLimitError: a joint would leave its limits.
    """
    waist = _rows("waist", waist, 3)
    left_foot = _rows("left_foot", left_foot, 3)
    right_foot = _rows("right_foot", right_foot, 3)
    _require_as_many_rows("left_foot", left_foot, waist)
    _require_as_many_rows("right_foot", right_foot, waist)
    q = np.empty((len(waist), len(JOINT_NAMES)))
    status, tick, joint = solve_legs(waist, left_foot, right_foot, q)
    if status != SOLVED:
        raise solve_error(status, tick, joint, waist, left_foot, right_foot, q)
    return q


def solve_legs(
    waist: Array, left_foot: Array, right_foot: Array, out: Array
) -> tuple[int, int, int]:
    """Fill ``out`` (n, 12) with joint positions: the form for the control loop.

    Same poses as ``leg_joint_positions``, but reports a failure instead of raising.
    Arrays must be C-contiguous float64; another layout or type works at the price of
    compiling anew.

    Returns:
        ``(status, tick, joint)``. Status ``SOLVED`` is 0; ``NOT_FINITE``,
        ``UNREACHABLE`` and ``BEYOND_JOINT_LIMIT`` are positive, tick is then the first
        row that has no solution and joint the column of the offending joint (the knee
        of the leg for the first two). Rows before that tick are filled, rows after it
        are left as they were. ``solve_error`` turns the answer into an exception.

    Raises:
        InvalidInputError: a shape is wrong.
    """
    n = len(waist)
    if not (
        waist.shape == left_foot.shape == right_foot.shape == (n, 3)
        and out.shape == (n, 12)
    ):
        raise InvalidInputError(
            "waist, left_foot and right_foot must have shape (n, 3) and out (n, 12), "
            f"got {waist.shape}, {left_foot.shape}, {right_foot.shape} and {out.shape}"
        )
    return kernels.fill_leg_joint_positions(
        waist, left_foot, right_foot, GEOMETRY, POSITION_LOWER, POSITION_UPPER, out
    )


def solve_error(
    status: int,
    tick: int,
    joint: int,
    waist: Array,
    left_foot: Array,
    right_foot: Array,
    out: Array,
) -> DescriptionError:
    """Return the exception that explains a failure of ``solve_legs``.

    Takes what ``solve_legs`` returned and the arrays it was given.
    """
    leg = joint // JOINTS_PER_LEG
    foot = (left_foot, right_foot)[leg]
    if status == NOT_FINITE:
        return InvalidInputError(
            f"tick {tick}: waist {waist[tick]} and {LEGS[leg]} foot {foot[tick]} "
            "must be finite"
        )
    if status == UNREACHABLE:
        hip_y = (GEOMETRY.half_hip_spacing, -GEOMETRY.half_hip_spacing)[leg]
        hip = waist[tick] + (0.0, hip_y, 0.0)
        ankle = foot[tick] + (0.0, 0.0, GEOMETRY.ankle_height)
        distance = float(np.linalg.norm(hip - ankle))
        return UnreachablePoseError(
            f"tick {tick}: hip and ankle of the {LEGS[leg]} leg are {distance:.6g} m "
            f"apart, but the leg spans only {GEOMETRY.reach_min:.6g} to "
            f"{GEOMETRY.reach_max:.6g} m"
        )
    if status == BEYOND_JOINT_LIMIT:
        return JointLimitError(
            f"tick {tick}: {JOINT_NAMES[joint]} at {out[tick, joint]:.6g} rad is "
            f"outside {POSITION_LOWER[joint]:.6g} to {POSITION_UPPER[joint]:.6g} rad"
        )
    raise ValueError(f"status {status} is not a failure of solve_legs")


def waist_to_feet(q: ArrayLike) -> tuple[Array, Array]:
    """Return the positions (n, 3) of the left and the right foot from the waist [m].

    Args:
        q: (n, 12) joint positions; the feet need not be flat. Axes are the torso's.
    """
    positions, _ = _foot_poses(q)
    return positions[0], positions[1]


def foot_orientations(q: ArrayLike) -> tuple[Array, Array]:
    """Return the rotations (n, 3, 3) of the left and the right foot to the torso.

    Their columns are the foot's x, y and z axes in the torso's frame; a flat foot
    under an upright torso gives the identity.

    Args:
        q: (n, 12) joint positions.
    """
    _, orientations = _foot_poses(q)
    return orientations[0], orientations[1]


def link_com_positions(waist: ArrayLike, q: ArrayLike) -> Array:
    """Return the CoM of every link (n, 13, 3), in the order of ``LINK_NAMES``.

    Args:
        waist: (n, 3) midpoint of the hip line.
        q: (n, 12) joint positions.
    """
    waist = _rows("waist", waist, 3)
    q = _rows("q", q, len(JOINT_NAMES))
    _require_as_many_rows("q", q, waist)
    out = np.empty((len(q), len(LINK_NAMES), 3))
    kernels.fill_link_coms(waist, q, GEOMETRY, out)
    return out


def com_position(waist: ArrayLike, q: ArrayLike) -> Array:
    """Return the CoM (n, 3) of the whole robot.

    Args:
        waist: (n, 3) midpoint of the hip line.
        q: (n, 12) joint positions.
    """
    coms = link_com_positions(waist, q)
    out = np.empty((len(coms), 3))
    kernels.fill_weighted_mean(coms, LINK_MASSES, out)
    return out


def _foot_poses(q: ArrayLike) -> tuple[Array, Array]:
    """Return positions (2, n, 3) and orientations (2, n, 3, 3) of both feet."""
    q = _rows("q", q, len(JOINT_NAMES))
    positions = np.empty((2, len(q), 3))
    orientations = np.empty((2, len(q), 3, 3))
    kernels.fill_foot_poses(q, GEOMETRY, positions, orientations)
    return positions, orientations


def _rows(name: str, values: ArrayLike, width: int) -> Array:
    """Return ``values`` as a contiguous, finite (n, width) array, or refuse it."""
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != width:
        raise InvalidInputError(f"{name} must be (n, {width}), got {array.shape}")
    finite = np.isfinite(array)
    if not finite.all():
        tick = int(np.argmin(finite.all(axis=1)))
        raise InvalidInputError(f"{name} at tick {tick} must be finite: {array[tick]}")
    return array


def _require_as_many_rows(name: str, array: Array, waist: Array) -> None:
    """Refuse an array that does not go with the waist, tick by tick."""
    if len(array) != len(waist):
        raise InvalidInputError(f"{name} has {len(array)} ticks, waist {len(waist)}")
