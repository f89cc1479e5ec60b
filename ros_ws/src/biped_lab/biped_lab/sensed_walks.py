"""Learned walks of a robot that is known by its sensors only.

    python -m biped_lab.sensed_walks --seeds 10 --walks 5

Learns the walk from the truth, from sensors with noise and one tick of delay, and from
these under limits that are 3 and 15 mm stricter, on the same seeds; then walks what was
learned, frozen, with ever worse sensors and the limit as it is by default, some walks
per seed, each with noise of its own. Prints a table in Markdown. Of the walks whose
learning came to its end: how many were completed; in how many of these the true ZMP
stayed within the limit, which the robot judges by its sensors; median and largest of
its worst errors; and how many walks of each seed were completed.
"""

from __future__ import annotations

import argparse
import math
import sys
from contextlib import closing
from statistics import median
from typing import Final

import numpy as np

from biped_bringup.run_settings import (
    PRESETS,
    RunSettings,
    changed_settings,
    load_settings,
)
from biped_bringup.walker import Walker
from biped_common.command_line import positive
from biped_common.seeds import trial_stream
from biped_lab.markdown import Table
from biped_lab.robustness import SENSED, Learned, learn, sensor_noise
from sim_node.control_tick import ControlTick
from sim_node.sensed_world import SensedWorld
from sim_node.simulated_hardware import SimulatedHardware

SENSES: Final = {
    "the truth": (),
    "sensors without noise or delay": (
        SENSED, *sensor_noise(0.0), "sim.sensors.delay_ticks=0",
    ),
    "one tick of delay": (SENSED, *sensor_noise(0.0)),
    "noise": (SENSED, "sim.sensors.delay_ticks=0"),
    "noise, one tick of delay": (SENSED,),
    "the same, ended at 68 mm": (SENSED, "sim.limits.zmp_error_m=0.068"),
    "noise, three ticks of delay": (SENSED, "sim.sensors.delay_ticks=3"),
    "three times the noise, one tick of delay": (SENSED, *sensor_noise(3.0)),
}  # fmt: skip

LEARNED_FROM: Final = {
    "truth": (),
    "sensors": (SENSED,),
    "sensors, within 62 mm": (SENSED, "sim.limits.zmp_error_m=0.062"),
    "sensors, within 50 mm": (SENSED, "sim.limits.zmp_error_m=0.050"),
}


def walked(
    learned: Learned,
    settings: RunSettings,
    seed: int,
    changes: tuple[str, ...],
    walks: int = 1,
) -> list[tuple[bool, float]]:
    """Walk what was learned some times.

    Returns:
        Of each walk, whether it came to the end, and the largest norm of the true ZMP
        error [m].
    """
    worst = 0.0

    def look(tick: ControlTick) -> None:
        nonlocal worst
        world, felt = walker.biped.world, tick.contact
        if isinstance(world, SensedWorld):
            if not isinstance(world.hardware, SimulatedHardware):
                raise TypeError("only a simulated robot knows its true ZMP")
            felt = world.hardware.contact
        if felt.loaded:
            x, y = tick.zmp_reference
            worst = max(worst, math.hypot(felt.zmp_x_m - x, felt.zmp_y_m - y))

    walker = Walker(
        changed_settings(settings, changes=changes),
        np.random.default_rng(trial_stream(seed)),
        look,
    )
    outcomes = []
    with closing(walker):
        for _ in range(walks):
            worst = 0.0
            completed = walker.walk(learned.walk()).completed
            outcomes.append((completed, worst))
    return outcomes


def cell(outcomes: list[list[tuple[bool, float]]], limit_m: float) -> str:
    """Return in words how the walks of each seed went."""
    peaks = [worst for walks in outcomes for completed, worst in walks if completed]
    if not peaks:
        return "0"
    within = sum(worst < limit_m for worst in peaks)
    median_mm, most_mm = 1000 * np.median(peaks), 1000 * max(peaks)
    by_seed = " ".join(str(sum(ended for ended, _ in walks)) for walks in outcomes)
    return f"{len(peaks)} ({within}), {median_mm:.1f}, {most_mm:.1f} mm; {by_seed}"


def main() -> int:
    """Learn, walk and print."""
    parser = argparse.ArgumentParser(
        prog="python -m biped_lab.sensed_walks", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--preset", choices=PRESETS, default="directed")
    parser.add_argument("--seeds", type=positive, default=10, metavar="N")
    parser.add_argument("--first", type=positive, default=8101, metavar="SEED")
    parser.add_argument(
        "--walks", type=positive, default=1, metavar="N", help="per seed (default 1)"
    )
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.seeds)
    columns: dict[str, list[str]] = {}
    truth = load_settings(options.preset)
    limit_m = truth.sim.limits.zmp_error_m
    for name, changes in LEARNED_FROM.items():
        settings = changed_settings(truth, changes=changes)
        found = {seed: learn(settings, seed) for seed in seeds}
        learned = {seed: walk for seed, walk in found.items() if walk is not None}
        print(f"{name}: {len(learned)} learned", file=sys.stderr, flush=True)
        took = median(math.inf if w is None else w.episodes for w in found.values())
        of = f"{len(learned)} of {len(seeds)}, median of {took:g} episodes"
        columns[f"learned from the {name} ({of})"] = [
            cell(
                [walked(w, truth, n, c, options.walks) for n, w in learned.items()],
                limit_m,
            )
            for c in SENSES.values()
        ]
    rows = zip(SENSES, *columns.values(), strict=True)
    print(Table(("walked by", *columns), tuple(rows)).markdown(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main())
