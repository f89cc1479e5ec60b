"""A robot: what follows from its table, above all its kinematics.

The torso is upright. Every array has one row per control tick. Positions are in the
world frame [m] unless the text says otherwise, joint positions in the order of
``JOINT_NAMES`` [rad].
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from biped_description import kernels
from biped_description.errors import (
    InvalidInputError,
    JointLimitError,
    UnreachablePoseError,
)
from biped_description.joints import JOINT_NAMES, JOINTS_PER_LEG, KNEE, LEGS
from biped_description.kernels import Array, ChainGeometry
from biped_description.links import LINK_NAMES, Link, all_links
from biped_description.settings import RobotSettings
from biped_description.urdf import urdf_text

# Slack by which a stretched leg, a legal pose, may seem too long [m].
_ROUNDING: Final = 1e-12


class LegMotion(NamedTuple):
    """Joint motion over n control ticks, as far as the legs can follow."""

    q: Array
    """(n, 12) positions [rad]; from an unsolved row on they mean nothing."""
    dq: Array
    """(n - 1, 12) velocities from each row to the next [rad/s]."""
    status: int
    """As in ``kernels``."""
    row: int
    """The first that has no solution, if the status is not ``SOLVED``."""
    joint: int
    """That cannot follow there; a knee where the pose is out of reach or no number."""


@dataclass(frozen=True)
class Robot:
    """A robot of the dimensions, masses and limits of its table."""

    settings: RobotSettings

    # -- limits and masses ---------------------------------------------------------

    @cached_property
    def position_lower_rad(self) -> Array:
        """(12,) lower position limits, in the order of JOINT_NAMES; read-only."""
        return _both_legs(self.settings.position_lower_rad)

    @cached_property
    def position_upper_rad(self) -> Array:
        """(12,) upper position limits, in the order of JOINT_NAMES; read-only."""
        return _both_legs(self.settings.position_upper_rad)

    @cached_property
    def torque_limit_nm(self) -> Array:
        """(12,) torque limits, in the order of JOINT_NAMES; read-only."""
        return _both_legs(self.settings.torque_limit_nm)

    @cached_property
    def links(self) -> tuple[Link, ...]:
        """The links, in the order of LINK_NAMES."""
        return all_links(self.settings)

    @cached_property
    def link_masses_kg(self) -> Array:
        """(13,) masses, in the order of LINK_NAMES; read-only."""
        return _read_only([link.mass for link in self.links])

    @cached_property
    def mass_kg(self) -> float:
        """Mass of the whole robot."""
        return float(self.link_masses_kg.sum())

    @property
    def urdf(self) -> str:
        """Its URDF, as XML."""
        return urdf_text(self.settings)

    # -- inverse kinematics --------------------------------------------------------

    def leg_joint_positions(
        self, waist: ArrayLike, left_foot: ArrayLike, right_foot: ArrayLike
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
        feet = _rows("left_foot", left_foot, 3), _rows("right_foot", right_foot, 3)
        for side, foot in zip(LEGS, feet, strict=True):
            _require_as_many_rows(f"{side}_foot", foot, waist)
        q = np.empty((len(waist), len(JOINT_NAMES)))
        status, tick, joint = kernels.fill_leg_joint_positions(
            waist,
            *feet,
            self._geometry,
            self.position_lower_rad,
            self.position_upper_rad,
            q,
        )
        if status == kernels.BEYOND_JOINT_LIMIT:
            raise JointLimitError(
                f"tick {tick}: {JOINT_NAMES[joint]} at {q[tick, joint]:.6g} rad is "
                f"outside {self.position_lower_rad[joint]:.6g} to "
                f"{self.position_upper_rad[joint]:.6g} rad"
            )
        if status != kernels.SOLVED:
            leg = joint // JOINTS_PER_LEG
            raise self._unreachable(tick, leg, waist[tick], feet[leg][tick])
        return q

    def leg_motion(
        self, waist: Array, left_foot: Array, right_foot: Array, period_s: float
    ) -> LegMotion:
        """Return the joint motion that follows waist and feet, for the control loop.

        Same poses as ``leg_joint_positions``, but reports a failure instead of raising.
        The (n, 3) arrays must be C-contiguous float64; another layout or type works at
        the price of compiling anew.

        Raises:
            InvalidInputError: a shape is wrong.
        """
        n = len(waist)
        if not waist.shape == left_foot.shape == right_foot.shape == (n, 3):
            raise InvalidInputError(
                "waist, left_foot and right_foot must have shape (n, 3), "
                f"got {waist.shape}, {left_foot.shape} and {right_foot.shape}"
            )
        q = np.empty((n, len(JOINT_NAMES)))
        dq = np.empty((max(n - 1, 0), len(JOINT_NAMES)))
        status, row, joint = kernels.fill_leg_motion(
            waist,
            left_foot,
            right_foot,
            self._geometry,
            self.position_lower_rad,
            self.position_upper_rad,
            period_s,
            q,
            dq,
        )
        return LegMotion(q, dq, status, row, joint)

    # -- forward kinematics --------------------------------------------------------

    def waist_to_feet(self, q: ArrayLike) -> tuple[Array, Array]:
        """Return the positions (n, 3) of left and right foot from the waist [m].

        Args:
            q: (n, 12) joint positions; the feet need not be flat. Axes are the torso's.
        """
        positions, _ = self.foot_poses(q)
        return positions[0], positions[1]

    def link_com_positions(self, waist: ArrayLike, q: ArrayLike) -> Array:
        """Return the CoM of every link (n, 13, 3), in the order of ``LINK_NAMES``.

        Args:
            waist: (n, 3) midpoint of the hip line.
            q: (n, 12) joint positions.
        """
        waist = _rows("waist", waist, 3)
        q = _rows("q", q, len(JOINT_NAMES))
        _require_as_many_rows("q", q, waist)
        out = np.empty((len(q), len(LINK_NAMES), 3))
        kernels.fill_link_coms(waist, q, self._geometry, out)
        return out

    def com_position(self, waist: ArrayLike, q: ArrayLike) -> Array:
        """Return the CoM (n, 3) of the whole robot.

        Args:
            waist: (n, 3) midpoint of the hip line.
            q: (n, 12) joint positions.
        """
        coms = self.link_com_positions(waist, q)
        out = np.empty((len(coms), 3))
        kernels.fill_weighted_mean(coms, self.link_masses_kg, out)
        return out

    # -- inner steps ---------------------------------------------------------------

    @cached_property
    def _geometry(self) -> ChainGeometry:
        table = self.settings
        return ChainGeometry(
            half_hip_spacing=table.half_hip_spacing_m,
            thigh_length=table.thigh_length_m,
            shank_length=table.shank_length_m,
            ankle_height=table.ankle_height_m,
            reach_min=self._span(table.position_upper_rad[KNEE]),
            reach_max=self._span(table.position_lower_rad[KNEE]) + _ROUNDING,
            torso_com_height=table.torso_com_height_m,
            thigh_com_below_hip=table.thigh_com_below_hip_m,
            shank_com_below_knee=table.shank_com_below_knee_m,
            foot_com_below_ankle=table.foot_com_below_ankle_m,
            foot_com_ahead_of_ankle=table.sole_ahead_of_ankle_m,
        )

    def _span(self, knee: float) -> float:
        """Return the distance from hip to ankle at a knee position [m]."""
        a, b = self.settings.thigh_length_m, self.settings.shank_length_m
        return float(np.sqrt(a * a + b * b + 2 * a * b * np.cos(knee)))

    def _unreachable(
        self, tick: int, leg: int, waist: Array, foot: Array
    ) -> UnreachablePoseError:
        geometry = self._geometry
        hip_y = geometry.half_hip_spacing * (1 - 2 * leg)  # left +, right -
        hip_from_ankle = waist - foot + np.array([0.0, hip_y, -geometry.ankle_height])
        distance = math.hypot(*hip_from_ankle)
        return UnreachablePoseError(
            f"tick {tick}: hip and ankle of the {LEGS[leg]} leg are {distance:.6g} m "
            f"apart, but the leg spans only {geometry.reach_min:.6g} to "
            f"{geometry.reach_max:.6g} m"
        )

    def foot_poses(self, q: ArrayLike) -> tuple[Array, Array]:
        """Return positions (2, n, 3) and orientations (2, n, 3, 3) of both feet."""
        q = _rows("q", q, len(JOINT_NAMES))
        positions = np.empty((2, len(q), 3))
        orientations = np.empty((2, len(q), 3, 3))
        kernels.fill_foot_poses(q, self._geometry, positions, orientations)
        return positions, orientations


def _read_only(values: ArrayLike) -> Array:
    array = np.array(values, dtype=np.float64)
    array.flags.writeable = False
    return array


def _both_legs(values: tuple[float, ...]) -> Array:
    """Repeat the six values of a leg for both legs."""
    return _read_only(2 * values)


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
