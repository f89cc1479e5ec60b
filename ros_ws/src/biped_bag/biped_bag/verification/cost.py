"""ZMP error and T_err of a recorded walk, computed anew from the 500 Hz topics.

Neither the recorded T_err nor the cost increments of the observations are used, and the
integrals of eq. (2) are summed over the whole walk at once: what agrees has been
computed twice. A bag whose 500 Hz topics are thinned or have holes leaves only the
observations' increments to be added up; that is said.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_bag.verification.walks import MEASURED, RecordedWalk, Samples
from biped_common.timing import CONTROL_PERIOD_S
from biped_description.joints import JOINT_NAMES
from learner_node.walking.cost import CostIntegral, cost_terms
from learner_node.walking.settings import CostSettings
from msgs_json import topics
from msgs_json.episode_result import CostTerms

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
    result = walk.result
    if result is None or result.cost is None or result.control_ticks == 0:
        return None
    measured = _complete(walk, result.control_ticks)
    if measured is None:
        integral = CostIntegral(settings)
        for observation in walk.observations:
            integral.add(observation)
        added_up = integral.terms(walk.observations[-1])
        if added_up is None:
            return None  # only the walk's beginning is in the bag
        return CostCheck(FROM_OBSERVATIONS, result.cost.total, added_up.total, None)
    zmp_error_m = measured[topics.ZMP.name] - measured[topics.ZMP_REFERENCE.name]
    peak_m = float(np.hypot(*zmp_error_m.T).max())
    return CostCheck(
        FROM_TOPICS,
        result.cost.total,
        _cost_of_topics(measured, zmp_error_m, settings).total,
        max(
            abs(peak_m - result.peak_zmp_error_m),
            _deviation_of_observations_m(walk, zmp_error_m),
        ),
    )


def _complete(
    walk: RecordedWalk, control_ticks: int
) -> dict[str, NDArray[np.float64]] | None:
    """Return the (ticks, m) values of each topic, if no control tick is missing."""
    none = Samples(np.array([], dtype=np.int64), np.array([]))
    found = {topic: walk.samples.get(topic, none) for topic in MEASURED}
    if any(len(samples.control_ticks) != control_ticks for samples in found.values()):
        return None
    every_tick = np.arange(1, control_ticks + 1)
    if any(
        not np.array_equal(samples.control_ticks, every_tick)
        for samples in found.values()
    ):
        return None
    return {topic: samples.values for topic, samples in found.items()}


def _cost_of_topics(
    measured: dict[str, NDArray[np.float64]],
    zmp_error_m: NDArray[np.float64],
    settings: CostSettings,
) -> CostTerms:
    n = len(JOINT_NAMES)
    states = measured[topics.JOINT_STATES.name].reshape(-1, 3, n)
    references = measured[topics.JOINT_REFERENCES.name].reshape(-1, 2, n)
    q_error = references[:, 0] - states[:, 0]
    dq_error = references[:, 1] - states[:, 1]
    torque = states[:, 2]
    time_s = CONTROL_PERIOD_S * np.arange(1, len(zmp_error_m) + 1)
    return cost_terms(
        settings,
        duration_s=float(time_s[-1]),
        zmp_m2_s2=float(((zmp_error_m**2).sum(1) * time_s).sum() * CONTROL_PERIOD_S),
        joint_rad2_s=float((q_error**2).sum() * CONTROL_PERIOD_S),
        torque_n2m2_s=float((torque**2).sum() * CONTROL_PERIOD_S),
        final_zmp_error_m=zmp_error_m[-1].tolist(),
        final_joint_error_rad=float(np.abs(q_error[-1]).mean()),
        final_joint_velocity_error_rad_s=float(np.abs(dq_error[-1]).mean()),
    )


def _deviation_of_observations_m(
    walk: RecordedWalk, zmp_error_m: NDArray[np.float64]
) -> float:
    """Return how far an observation's ZMP error is from that of the topics at most."""
    deviations_m = (
        float(np.hypot(*np.subtract(o.zmp_error_m, zmp_error_m[o.control_tick - 1])))
        for o in walk.observations
        if 0 < o.control_tick <= len(zmp_error_m)
    )
    return max(deviations_m, default=0.0)
