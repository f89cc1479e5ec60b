"""One seed, one stream of random numbers for each part of a run."""

from __future__ import annotations

import numpy as np


def learner_stream(seed: int) -> np.random.SeedSequence:
    """Return the learner's stream of a seed."""
    return np.random.SeedSequence(seed).spawn(2)[0]


def robot_stream(seed: int) -> np.random.SeedSequence:
    """Return the disturbances' stream of a seed."""
    return np.random.SeedSequence(seed).spawn(2)[1]
