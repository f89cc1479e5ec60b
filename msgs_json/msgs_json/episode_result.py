"""How an episode ended, what it cost and what the learner got for it."""

from __future__ import annotations

import msgspec

from msgs_json.bounds import Count, Digest
from msgs_json.end_cause import EndCause


class CostTerms(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The six terms of T_err, eq. (2), in the order of the paper; they add up to it."""

    zmp: float
    """ZMP error over the walk, late errors weighing more []."""
    final_zmp: float
    """ZMP error at the end []."""
    joint_tracking: float
    """Tracking error of the joints over the walk []."""
    joint_torque: float
    """Joint torques over the walk []."""
    final_joint_position: float
    """Mean position error of the joints at the end []."""
    final_joint_velocity: float
    """Mean velocity error of the joints at the end []."""

    @property
    def total(self) -> float:
        """T_err."""
        return (
            self.zmp
            + self.final_zmp
            + self.joint_tracking
            + self.joint_torque
            + self.final_joint_position
            + self.final_joint_velocity
        )


class EpisodeResult(
    msgspec.Struct,
    frozen=True,
    kw_only=True,
    forbid_unknown_fields=True,
    tag_field="version",
    tag=1,
):
    """One walk, from standing to its end."""

    episode: Count
    """Number of the walk, as the simulation counts."""
    learning: bool
    """Walked to learn from, not frozen; of one that ends from outside nothing is."""
    end_cause: EndCause
    """Why the walk ended."""
    control_ticks: Count
    """Control ticks walked."""
    target_ticks: Count
    """Control ticks to walk for success."""
    peak_zmp_error_m: float
    """Largest norm of the ZMP error [m]."""
    peak_joint_velocity_rad_s: float
    """Largest joint speed [rad/s]."""
    cost: CostTerms | None
    """Terms of T_err; None before the first control tick."""
    t_err_estimate: float | None
    """T_err-hat that T_err was compared with; None the first time and on failure."""
    reward: float
    """rwd of Table 2, or 0."""
    subtask: Count
    """0-based place in the learning schedule."""
    trajectory_sha256: Digest
    """Hash of all that the walk measured."""
    schedule_complete: bool
    """The last subtask has been passed, now or before."""

    @property
    def completed(self) -> bool:
        """The walk reached its target time."""
        return self.end_cause is EndCause.COMPLETED
