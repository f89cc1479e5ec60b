"""The whole environment tick against bare `stepSimulation`, on the same motion.

Both walk the static walk, limits out of the way, in turns; the ratio is that of the
medians over the turns, so that a drift of the machine's speed cancels out. The bare
loop gets the same commands, but only the time inside `stepSimulation` is counted.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

from benchmarks.report import Figure
from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import Walker
from biped_common.settings import from_mapping
from learner_node.walking.walks import static_walk
from sim_node.control_tick import ControlTick

_TURNS = 7
_RATIO_BOUND = 1.4


def measure() -> list[Figure]:
    """Return microseconds per control tick and the ratio."""
    settings = from_mapping(RunSettings, {"sim": {"limits": {"zmp_error_m": 1.0}}})
    commands = _recorded_commands(settings)
    walker = Walker(settings, np.random.default_rng(0))
    walk = static_walk(settings.learner, walker.walk_ticks)
    whole, bare = [], []
    for _ in range(_TURNS):
        start = time.perf_counter()
        result = walker.walk(walk)
        whole.append((time.perf_counter() - start) / result.control_ticks)
        bare.append(_bare_tick_s(walker, commands))
    walker.close()
    whole_us, bare_us = (1e6 * statistics.median(times) for times in (whole, bare))
    return [
        Figure("stepSimulation alone, per control tick", bare_us, "us"),
        Figure("whole environment, per control tick", whole_us, "us"),
        Figure(
            "whole environment / stepSimulation", whole_us / bare_us, "", _RATIO_BOUND
        ),
        Figure("simulated seconds per second", 2000.0 / whole_us, ""),
    ]


def _recorded_commands(
    settings: RunSettings,
) -> list[tuple[list[float], list[float]]]:
    """Walk once and return what the servos were told; compiles everything, too."""
    references: list[list[float]] = []

    def record(tick: ControlTick) -> None:
        references.append(tick.joint_reference)

    walker = Walker(settings, np.random.default_rng(0), record)
    walker.walk(static_walk(settings.learner, walker.walk_ticks))
    walker.close()
    velocities = (np.diff(references, axis=0) / 0.002).tolist()
    return list(zip(references[:-1], velocities, strict=True))


def _bare_tick_s(
    walker: Walker, commands: list[tuple[list[float], list[float]]]
) -> float:
    world = walker.biped.world
    walker.biped.begin_walk(episode=1)
    spent = 0.0
    for q, dq in commands:
        world.command(q, dq)
        start = time.perf_counter()
        world.step()
        spent += time.perf_counter() - start
    return spent / len(commands)
