"""Where the states of a walking learner lie over the waist plane."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from learner_node.walking.session import LearningSession
from learner_node.walking.settings import LearnerSettings
from learner_node.walking.task import INPUT_NAMES, N_DISCRETE

_WAIST = [INPUT_NAMES.index(name) - N_DISCRETE for name in ("waist_x", "waist_y")]


class LearnedStates(NamedTuple):
    """The states of a memory over the waist plane; n of them."""

    waist_m: NDArray[np.float64]
    """(n, 2) centres, relative to the support foot's ankle point."""
    fixed: NDArray[np.bool_]
    """(n,) no longer exploring."""
    penalty: NDArray[np.bool_]
    """(n,) all that is left to choose is penalised."""

    @property
    def modes(self) -> dict[str, NDArray[np.bool_]]:
        """(n,) which states are in each mode, by its name."""
        return {
            "exploring": ~self.fixed & ~self.penalty,
            "fixed": self.fixed & ~self.penalty,
            "penalty": self.penalty,
        }


def learned_states(session: LearningSession) -> LearnedStates:
    """Return the states of a learner; of one without modes all are exploring."""
    memory = session.learner.memory()
    waist_m = waist_of_states(session.settings, memory["state_centers"])
    none = np.zeros(len(waist_m), dtype=np.bool_)
    return LearnedStates(
        waist_m, memory.get("fixed", none), memory.get("penalty_state", none)
    )


def waist_of_states(
    settings: LearnerSettings, centers: NDArray[Any]
) -> NDArray[np.float64]:
    """Return the (n, 2) waist positions of states, from the support foot's ankle [m].

    Args:
        settings: of the learner that made them.
        centers: (n, n_continuous) centres in units of the inputs' radii.
    """
    waist_m: NDArray[np.float64] = (
        centers[:, _WAIST] * np.array(settings.inputs.radii)[_WAIST]
    )
    return waist_m
