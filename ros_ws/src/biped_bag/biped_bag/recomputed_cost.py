"""ZMP error and T_err of a recorded walk, computed anew from the 500 Hz topics.

Neither the recorded T_err nor the cost increments of the observations are used, and the
sums run over the whole walk at once: what agrees has been computed twice. The formula
is that of `learner_node.walking.cost`. A bag whose 500 Hz topics are thinned or have
holes leaves only the observations' increments to be added up; that is said.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_bag.recorded_walks import MEASURED, RecordedWalk, Samples
from biped_common.timing import CONTROL_PERIOD_S, seconds
from learner_node.walking.settings import CostSettings
from msgs_json import topics

_N_JOINTS = 12
FROM_TOPICS = "500 Hz topics"
FROM_OBSERVATIONS = "cost increments of the observations"


@dataclass(frozen=True)
class CostCheck:
    """T_err and the ZMP error of a walk, recorded and computed anew."""

    source: str
    """FROM_TOPICS, or FROM_OBSERVATIONS where the topics are not complete."""
    t_err_recorded: float
    t_err_recomputed: float
    zmp_error_deviation_m: float | None
    """Largest distance from an observation's ZMP error, or from the peak of the result,
    to that of the topics; None without them."""

    @property
    def t_err_deviation(self) -> float:
        """Distance of the two values of T_err."""
        return abs(self.t_err_recomputed - self.t_err_recorded)


def recomputed_cost(walk: RecordedWalk, settings: CostSettings) -> CostCheck | None:
    """Compute the cost of a walk anew; None where there is none to compare with.

    Args:
        walk: from its first observation to its result.
        settings: of the learner that computed the recorded cost.
    """
    if walk.result is None or walk.result.cost is None:
        return None
    measured = _complete(walk)
    recorded = walk.result.cost.total
    if measured is None:
        added_up = _t_err_of_observations(walk, settings)
        return CostCheck(FROM_OBSERVATIONS, recorded, added_up, None)
    return CostCheck(
        FROM_TOPICS,
        recorded,
        _t_err_of_topics(measured, settings),
        _zmp_error_deviation_m(walk, measured),
    )


def _complete(walk: RecordedWalk) -> dict[str, NDArray[np.float64]] | None:
    """Return the (ticks, m) values of each topic, if no control tick is missing."""
    if walk.result is None:
        return None
    every_tick = np.arange(1, walk.result.control_ticks + 1)
    none = Samples(np.array([], dtype=np.int64), np.array([]))
    found = {topic: walk.samples.get(topic, none) for topic in MEASURED}
    if any(
        not np.array_equal(samples.control_ticks, every_tick)
        for samples in found.values()
    ):
        return None
    return {topic: samples.values for topic, samples in found.items()}


def _t_err_of_topics(
    measured: dict[str, NDArray[np.float64]], settings: CostSettings
) -> float:
    zmp_error = measured[topics.ZMP.name] - measured[topics.ZMP_REFERENCE.name]
    states = measured[topics.JOINT_STATES.name].reshape(-1, 3, _N_JOINTS)
    references = measured[topics.JOINT_REFERENCES.name].reshape(-1, 2, _N_JOINTS)
    q_error = references[:, 0] - states[:, 0]
    dq_error = references[:, 1] - states[:, 1]
    torque = states[:, 2]
    time_s = CONTROL_PERIOD_S * np.arange(1, len(zmp_error) + 1)
    return _t_err(
        settings,
        duration_s=float(time_s[-1]),
        zmp_m2_s2=float(((zmp_error**2).sum(1) * time_s).sum() * CONTROL_PERIOD_S),
        final_zmp_m=float(np.abs(zmp_error[-1]).sum()),
        joints_rad2_s=float((q_error**2).sum() * CONTROL_PERIOD_S),
        torques_n2m2_s=float((torque**2).sum() * CONTROL_PERIOD_S),
        final_joint_rad=float(np.abs(q_error[-1]).mean()),
        final_joint_rad_s=float(np.abs(dq_error[-1]).mean()),
    )


def _t_err_of_observations(walk: RecordedWalk, settings: CostSettings) -> float:
    observations, last = walk.observations, walk.observations[-1]
    return _t_err(
        settings,
        duration_s=seconds(last.control_tick),
        zmp_m2_s2=sum(o.zmp_error_integral_m2_s2 for o in observations),
        final_zmp_m=sum(map(abs, last.zmp_error_m)),
        joints_rad2_s=sum(o.joint_error_integral_rad2_s for o in observations),
        torques_n2m2_s=sum(o.torque_integral_n2m2_s for o in observations),
        final_joint_rad=last.mean_joint_error_rad,
        final_joint_rad_s=last.mean_joint_velocity_error_rad_s,
    )


def _t_err(
    settings: CostSettings,
    *,
    duration_s: float,
    zmp_m2_s2: float,
    final_zmp_m: float,
    joints_rad2_s: float,
    torques_n2m2_s: float,
    final_joint_rad: float,
    final_joint_rad_s: float,
) -> float:
    """Return eq. (2)."""
    tracking, torque = 1000.0 * joints_rad2_s, torques_n2m2_s / 1000.0
    if settings.torque_reading == "in_root":
        effort = math.sqrt(tracking + torque)
    else:
        effort = math.sqrt(tracking) + torque
    integrals = (zmp_m2_s2 / settings.zmp_limit_m**2 + effort) / duration_s
    return integrals + 50.0 * final_zmp_m + 10.0 * (final_joint_rad + final_joint_rad_s)


def _zmp_error_deviation_m(
    walk: RecordedWalk, measured: dict[str, NDArray[np.float64]]
) -> float:
    zmp_error = measured[topics.ZMP.name] - measured[topics.ZMP_REFERENCE.name]
    deviations = [
        float(np.hypot(*np.subtract(o.zmp_error_m, zmp_error[o.control_tick - 1])))
        for o in walk.observations
        if 0 < o.control_tick <= len(zmp_error)
    ]
    if walk.result is not None:
        peak_m = float(np.hypot(*zmp_error.T).max())
        deviations.append(abs(peak_m - walk.result.peak_zmp_error_m))
    return max(deviations)
