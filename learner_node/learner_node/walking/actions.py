"""The corrections that the learner chooses from (Section 4.2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from learner_node.walking.settings import ActionSettings

N_COMPONENTS = 2  # Nm: dx and dy
NO_CORRECTION_M = np.zeros(N_COMPONENTS)
NO_CORRECTION_M.flags.writeable = False


def corrections_m(settings: ActionSettings) -> NDArray[np.float64]:
    """Return the (Na,) alternatives of either component [m]."""
    return np.linspace(-settings.limit_m, settings.limit_m, settings.alternatives)
