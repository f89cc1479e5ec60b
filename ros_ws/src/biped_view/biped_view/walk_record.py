"""A walk as arrays, one row per control tick: what is drawn, wherever it came from.

A memory is walked in this process, a bag is read; page, figures and animation see the
same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from biped_bringup.run_settings import RunSettings
from biped_description.settings import RobotSettings
from learner_node.walking.session import LearningSession
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult

Rows = NDArray[np.float64]


@dataclass(frozen=True)
class WalkRecord:
    """What a walk of n control ticks was; world frame, row 0 is tick 1.

    What a source did not hold is NaN in whole rows (the cost of a walk that was cut off
    is None): nothing is made up.
    """

    robot: RobotSettings
    """Dimensions and limits of the robot that walked."""
    zmp_limit_m: float
    """Norm of the ZMP error at which the walk fails [m]."""
    walk_ticks: int
    """Control ticks of the whole walk, had it not ended before."""
    joint_position_rad: Rows
    """(n, 12) measured."""
    joint_velocity_rad_s: Rows
    """(n, 12) measured."""
    joint_torque_nm: Rows
    """(n, 12) applied."""
    joint_reference_rad: Rows
    """(n, 12) asked for."""
    torso_position_m: Rows
    """(n, 3) origin of the torso link."""
    torso_quaternion: Rows
    """(n, 4) orientation of the torso link, (w, x, y, z)."""
    zmp_m: Rows
    """(n, 2) measured; held while no foot is loaded."""
    zmp_reference_m: Rows
    """(n, 2) planned."""
    waist_m: Rows
    """(n, 3) the corrected waist reference, middle of the hip line."""
    static_waist_m: Rows
    """(n, 3) the same without corrections."""
    left_foot_m: Rows
    """(n, 3) reference of the left sole under the ankle."""
    right_foot_m: Rows
    """(n, 3) reference of the right sole under the ankle."""
    right_support: NDArray[np.bool_]
    """(n,) planned support leg; in double support the coming stance leg."""
    double_support: NDArray[np.bool_]
    """(n,) planned."""
    step_index: NDArray[np.int64]
    """(n,) single supports begun so far."""
    correction_m: Rows
    """(n, 2) what the learner chose for the learning tick that the row belongs to."""
    end_cause: EndCause | None
    """Why the walk ended; None where the recording ends before the walk."""
    result: EpisodeResult | None
    """What the learner made of it; None where the recording does not hold it."""

    @property
    def ticks(self) -> int:
        """Control ticks walked."""
        return len(self.zmp_m)

    @property
    def zmp_error_m(self) -> Rows:
        """(n, 2) measured minus planned."""
        return self.zmp_m - self.zmp_reference_m

    def known_rows(self) -> NDArray[np.int64]:
        """Return the rows of which pose, joints and ZMP are known, in their order."""
        told = np.hstack(
            (self.joint_position_rad, self.torso_position_m, self.zmp_m,
             self.zmp_reference_m)
        )  # fmt: skip
        return np.flatnonzero(np.isfinite(told).all(axis=1))


def last_known(known: NDArray[np.int64], rows: ArrayLike) -> NDArray[np.int64]:
    """Return for each row the last known one up to it, or the first known one.

    Args:
        known: (n,) rows, n > 0, in their order.
        rows: (m,) rows of the walk.
    """
    before = np.searchsorted(known, rows, side="right") - 1
    return known[np.maximum(before, 0)]


@dataclass(frozen=True)
class LoadedWalk:
    """A walk, and what else its source tells of it."""

    title: str
    """What was walked, in a few words."""
    record: WalkRecord
    settings: RunSettings
    """Of the whole run."""
    session: LearningSession | None = None
    """The learner that chose the corrections, with its log of episodes; None where
    nobody chose, or the source does not hold what was known then."""
    facts: Mapping[str, str] = field(default_factory=dict)
    """Where it comes from, by name: file, command, seed, versions, hashes."""
    remarks: tuple[str, ...] = ()
    """Sentences on what the source does not hold."""
