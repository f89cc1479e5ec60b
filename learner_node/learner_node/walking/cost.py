"""T_err, the cost of a walk (eq. (2)), and its running estimate (eqs. (3), (4)).

The formula is garbled in the paper's text. It is read as

    T_err = (1/t_f) int (|Z_err| / zmpLimit)^2 t dt
          + 50 (|Z_err,x(t_f)| + |Z_err,y(t_f)|)
          + (1/t_f) sqrt(1000 int |q^ - q|^2 dt + (1/1000) int |u|^2 dt)
          + 10 mean |q^ - q|(t_f) + 10 mean |dq^ - dq|(t_f)

with lengths in metres. The root is split over its two radicands in proportion, so that
six terms can be reported that add up.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from biped_common.timing import seconds
from learner_node.walking.settings import CostSettings
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import CostTerms, EpisodeResult
from msgs_json.observation import Observation

_FINAL_ZMP_WEIGHT = 50.0
_TRACKING_WEIGHT = 1000.0
_TORQUE_WEIGHT = 1.0 / 1000.0
_FINAL_JOINT_WEIGHT = 10.0


def cost_terms(
    settings: CostSettings,
    *,
    duration_s: float,
    zmp_m2_s2: float,
    joint_rad2_s: float,
    torque_n2m2_s: float,
    final_zmp_error_m: Sequence[float],
    final_joint_error_rad: float,
    final_joint_velocity_error_rad_s: float,
) -> CostTerms:
    """Return the six terms of T_err, eq. (2).

    Args:
        settings: limit of the ZMP error, and how the torque term is read.
        duration_s: t_f, above 0.
        zmp_m2_s2: int |Z_err|^2 t dt.
        joint_rad2_s: int |q^ - q|^2 dt.
        torque_n2m2_s: int |u|^2 dt.
        final_zmp_error_m: (2,) Z_err(t_f), x and y.
        final_joint_error_rad: mean |q^ - q|(t_f).
        final_joint_velocity_error_rad_s: mean |dq^ - dq|(t_f).
    """
    tracking = _TRACKING_WEIGHT * joint_rad2_s
    torque = _TORQUE_WEIGHT * torque_n2m2_s
    if settings.torque_reading == "in_root":
        root = math.sqrt(tracking + torque)
        share = tracking / (tracking + torque) if root > 0.0 else 0.0
        tracking, torque = root * share, root * (1.0 - share)
    else:
        tracking = math.sqrt(tracking)
    return CostTerms(
        zmp=zmp_m2_s2 / settings.zmp_limit_m**2 / duration_s,
        final_zmp=_FINAL_ZMP_WEIGHT * sum(abs(e) for e in final_zmp_error_m),
        joint_tracking=tracking / duration_s,
        joint_torque=torque / duration_s,
        final_joint_position=_FINAL_JOINT_WEIGHT * final_joint_error_rad,
        final_joint_velocity=_FINAL_JOINT_WEIGHT * final_joint_velocity_error_rad_s,
    )


class CostIntegral:
    """Adds up the cost increments of a walk, observation by observation."""

    def __init__(self, settings: CostSettings) -> None:
        """Start at zero."""
        self._settings = settings
        self.reset()

    def reset(self) -> None:
        """Start over, for the next walk."""
        self._zmp_m2_s2 = 0.0
        self._joint_rad2_s = 0.0
        self._torque_n2m2_s = 0.0
        self.peak_zmp_error_m = 0.0
        self.peak_joint_velocity_rad_s = 0.0

    def add(self, observation: Observation) -> None:
        """Add the increments of one learning tick."""
        self._zmp_m2_s2 += observation.zmp_error_integral_m2_s2
        self._joint_rad2_s += observation.joint_error_integral_rad2_s
        self._torque_n2m2_s += observation.torque_integral_n2m2_s
        self.peak_zmp_error_m = max(
            self.peak_zmp_error_m, observation.worst_zmp_error_m
        )
        self.peak_joint_velocity_rad_s = max(
            self.peak_joint_velocity_rad_s, observation.worst_joint_velocity_rad_s
        )

    def terms(self, last: Observation) -> CostTerms | None:
        """Return T_err's terms for a walk that ends with `last`; None at tick 0."""
        t_f = seconds(last.control_tick)
        if t_f == 0.0:
            return None
        return cost_terms(
            self._settings,
            duration_s=t_f,
            zmp_m2_s2=self._zmp_m2_s2,
            joint_rad2_s=self._joint_rad2_s,
            torque_n2m2_s=self._torque_n2m2_s,
            final_zmp_error_m=last.zmp_error_m,
            final_joint_error_rad=last.mean_joint_error_rad,
            final_joint_velocity_error_rad_s=last.mean_joint_velocity_error_rad_s,
        )

    def result(
        self,
        last: Observation,
        cause: EndCause,
        target_ticks: int,
        *,
        learning: bool = False,
        compared_with: float | None = None,
        reward: float = 0.0,
        subtask: int = 0,
        schedule_complete: bool = False,
    ) -> EpisodeResult:
        """Return the result of a walk that ends with `last`."""
        return EpisodeResult(
            episode=last.episode,
            learning=learning,
            end_cause=cause,
            control_ticks=last.control_tick,
            target_ticks=target_ticks,
            peak_zmp_error_m=self.peak_zmp_error_m,
            peak_joint_velocity_rad_s=self.peak_joint_velocity_rad_s,
            cost=self.terms(last),
            t_err_estimate=compared_with,
            reward=reward,
            subtask=subtask,
            trajectory_sha256=last.trajectory_sha256,
            schedule_complete=schedule_complete,
        )


class CostEstimate:
    """T_err-hat: what a good walk of the present subtask costs."""

    def __init__(self, settings: CostSettings) -> None:
        """Start without an estimate."""
        self._settings = settings
        self.value: float | None = None

    def is_success(self, t_err: float) -> bool:
        """Return whether a walk deserves RWDforSuc: the first, or T_err < T_err-hat."""
        if self.value is None:
            return True
        return t_err < (1.0 + self._settings.tolerance) * self.value

    def update(self, t_err: float) -> None:
        """Take a completed walk into account (eqs. (3), (4)), after `is_success`."""
        if self.value is None:
            self.value = self._settings.first_estimate_factor * t_err
        elif t_err < self.value:
            self.value = 0.5 * self.value + 0.5 * t_err
        else:
            self.value = 0.9 * self.value + 0.1 * t_err
