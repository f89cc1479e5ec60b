"""The disturbances of one walk, drawn before it starts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from biped_common.timing import control_ticks
from sim_node.settings import DisturbanceSettings


@dataclass(frozen=True)
class Disturbance:
    """One walk's draw."""

    push_from_tick: int
    push_to_tick: int
    push_force_n: tuple[float, float, float]
    mass_factors: NDArray[np.float64]
    """(links,) true over nominal mass."""


def draw_disturbance(
    settings: DisturbanceSettings, n_links: int, rng: np.random.Generator
) -> Disturbance:
    """Draw a walk's disturbances; the draws happen also where their size is zero.

    The stream of random numbers is then the same for every size of a disturbance.
    """
    direction = rng.uniform(0.0, 2.0 * math.pi)
    errors = rng.standard_normal(n_links)
    start = control_ticks(settings.push_time_s)
    ticks = max(1, control_ticks(settings.push_duration_s))
    force = settings.push_force_n
    # A link can be light, but never without mass.
    factors = np.maximum(1.0 + settings.mass_error * errors, 0.1)
    return Disturbance(
        push_from_tick=start,
        push_to_tick=start + ticks if force > 0.0 else start,
        push_force_n=(force * math.cos(direction), force * math.sin(direction), 0.0),
        mass_factors=factors,
    )
