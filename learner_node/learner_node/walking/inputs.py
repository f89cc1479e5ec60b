"""From an observation to the eight sensory inputs of Section 4.1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from msgs_json.observation import Observation

# The paper's values for its two discrete inputs.
_YES, _NO = 10.0, -10.0


def sensory_input(observation: Observation) -> NDArray[np.float64]:
    """Return the (8,) inputs, in the order of INPUT_NAMES.

    Flags are the planned ones, +10 or -10; the rest is in SI units and is scaled by the
    widths of the basis functions.
    """
    phase = observation.phase
    return np.array(
        (
            _YES if phase.planned_right_support else _NO,
            _YES if phase.planned_double_support else _NO,
            *observation.waist_in_support_foot_m,
            *observation.zmp_error_m,
            *observation.waist_acceleration_m_s2,
        )
    )
