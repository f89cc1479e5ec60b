"""A step of each engine on the same motion, and what each walks while learning.

The worlds walk the static walk, limits out of the way, and take turns of a fifth of a
simulated second; while learning, they take turns of an episode, without replay. All
times are those of the processor. Ratios are to PyBullet.
"""

from __future__ import annotations

import time
from itertools import pairwise

import numpy as np

from benchmarks.report import Figure
from biped_bringup.run_settings import RunSettings, changed_settings, load_settings
from biped_bringup.training import TrainingRun
from biped_bringup.walker import Walker
from biped_common.timing import CONTROL_PERIOD_S, seconds
from learner_node.walking.walks import static_walk
from sim_node.control_tick import ControlTick
from sim_node.engines import ENGINES
from sim_node.physics import Array

_WALKS = 3
_TURN = 100  # control ticks
_EPISODES = 12
_BASE = "pybullet"


def measure() -> list[Figure]:
    """Return microseconds per step, simulated seconds per CPU second, and ratios."""
    step_us, walked_s = _step_us(), _walked_while_learning_s()
    figures = [
        *(Figure(f"step of {name}", step_us[name], "us") for name in ENGINES),
        *(
            Figure(f"simulated s per CPU s, learning on {name}", walked_s[name], "")
            for name in ENGINES
        ),
    ]
    for name in ENGINES:
        if name != _BASE:
            step = step_us[name] / step_us[_BASE]
            learning = walked_s[name] / walked_s[_BASE]
            figures += [
                Figure(f"time of a step, {name} / {_BASE}", step, ""),
                Figure(f"walked while learning, {name} / {_BASE}", learning, ""),
            ]
    return figures


def _on(engine: str, *changes: str) -> RunSettings:
    changes = f"sim.engine={engine}", *changes
    return changed_settings(load_settings("quick"), changes=changes)


def _step_us() -> dict[str, float]:
    """Return the median over walks and turns, by engine."""
    q = _recorded_references()
    dq = np.diff(q, axis=0) / CONTROL_PERIOD_S
    bipeds = {
        name: Walker(_on(name), np.random.default_rng(0)).biped for name in ENGINES
    }
    turns: dict[str, list[float]] = {name: [] for name in ENGINES}
    measured = np.empty(3 * q.shape[1])
    for walk in range(1, _WALKS + 1):
        for biped in bipeds.values():
            biped.begin_walk(walk)
        for first, last in pairwise(range(0, len(dq), _TURN)):
            for name, biped in bipeds.items():
                step, start = biped.world.step, time.process_time()
                for row in range(first, last):
                    step(q[row], dq[row], measured)
                turns[name].append(time.process_time() - start)
    for biped in bipeds.values():
        biped.close()
    return {name: 1e6 * float(np.median(s)) / _TURN for name, s in turns.items()}


def _walked_while_learning_s() -> dict[str, float]:
    """Return simulated seconds per CPU second, by engine."""
    runs = {name: TrainingRun(_on(name), 0, replay_bytes=0) for name in ENGINES}
    for run in runs.values():
        run.episode()  # compiles everything
        run.cpu_s, run.walker.ticks.computed = 0.0, 0
    for _ in range(_EPISODES):
        for run in runs.values():
            run.episode()
    for run in runs.values():
        run.close()
    return {
        name: seconds(run.walker.ticks.computed) / run.cpu_s
        for name, run in runs.items()
    }


def _recorded_references() -> Array:
    """Return the joint positions asked for in the static walk (ticks, 12)."""
    references: list[list[float]] = []

    def record(tick: ControlTick) -> None:
        references.append(tick.joint_reference)

    settings = _on("kinematic", "sim.limits.zmp_error_m=1.0")
    walker = Walker(settings, np.random.default_rng(0), record)
    walker.walk(static_walk(settings.learner, walker.walk_ticks))
    walker.close()
    return np.array(references)
