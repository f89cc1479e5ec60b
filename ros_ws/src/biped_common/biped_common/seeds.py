"""One seed, one stream of random numbers for each part of a run."""

from __future__ import annotations

import numpy as np


def learner_stream(seed: int) -> np.random.SeedSequence:
    """Return the learner's stream of a seed."""
    return np.random.SeedSequence(seed).spawn(3)[0]


def robot_stream(seed: int) -> np.random.SeedSequence:
    """Return the disturbances' stream of a seed."""
    return np.random.SeedSequence(seed).spawn(3)[1]


def trial_stream(seed: int) -> np.random.SeedSequence:
    """Return the disturbances' stream of walks that test what was learned with it."""
    return np.random.SeedSequence(seed).spawn(3)[2]
