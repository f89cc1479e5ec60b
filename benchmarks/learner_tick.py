"""The learner's cost per 20 ms tick and its memory per state, against their bounds.

A tick is all that the learner does between two observations without a reward or a
penalty: look up the state, choose, count, queue, discount, add up the cost.
"""

from __future__ import annotations

import statistics
import time

import numpy as np

from benchmarks.report import Figure
from learner_node.methods import make_learner
from learner_node.walking.settings import LearnerSettings
from learner_node.walking.task import WalkTask
from learner_node.walking.walks import LearningWalk
from msgs_json.observation import Observation, PhaseFlags

_BOUNDS_US = {300: 20.0, 20_000: 60.0}
_TURNS = 9
_TICKS = 2_000
_WALK_TICKS = 5_625


def measure() -> list[Figure]:
    """Return microseconds per tick at two sizes of memory, and bytes per state."""
    figures = []
    for n_states, bound_us in _BOUNDS_US.items():
        task = WalkTask(LearnerSettings(), _WALK_TICKS)
        learner = make_learner(task.settings, task.problem, np.random.default_rng(0))
        walk = LearningWalk(task, learner)
        rng = np.random.default_rng(1)
        # Spread far beyond the basis functions' widths, so that each makes a state.
        observations = [_observation(rng, tick=10 + i) for i in range(n_states)]
        walk.respond(_observation(rng, tick=0))
        for observation in observations:
            walk.respond(observation)
        visits = rng.integers(0, n_states, _TICKS)
        times = []
        for _ in range(_TURNS):
            start = time.perf_counter()
            for i in visits:
                walk.respond(observations[i])
            times.append((time.perf_counter() - start) / _TICKS)
        figures.append(
            Figure(
                f"learner per 20 ms tick, {learner.figures()['basis_states']:g} states",
                1e6 * statistics.median(times),
                "us",
                bound_us,
            )
        )
    memory = learner.memory()
    size = sum(array.nbytes for array in memory.values()) / len(memory["state_life"])
    figures.append(Figure("memory file per basis state", size, "bytes"))
    return figures


def _observation(rng: np.random.Generator, tick: int) -> Observation:
    right, double = rng.integers(0, 2, 2)
    values = rng.uniform(-1.0, 1.0, (3, 2)) * (100.0, 100.0)
    # Ticks stay below the first target and on a decision.
    tick = 10 * (1 + tick % 90) if tick else 0
    return Observation(
        simulation="benchmark",
        episode=1,
        clock_ticks=tick,
        control_tick=tick,
        phase=PhaseFlags(
            planned_right_support=bool(right),
            planned_double_support=bool(double),
            measured_right_support=bool(right),
            measured_double_support=bool(double),
            step_index=0,
        ),
        waist_in_support_foot_m=tuple(values[0]),
        zmp_error_m=tuple(values[1]),
        waist_acceleration_m_s2=tuple(values[2]),
        worst_zmp_error_m=0.01,
        worst_joint_velocity_rad_s=1.0,
        zmp_error_integral_m2_s2=1e-6,
        joint_error_integral_rad2_s=1e-9,
        torque_integral_n2m2_s=1.0,
        mean_joint_error_rad=0.0,
        mean_joint_velocity_error_rad_s=0.0,
        trajectory_sha256="",
    )
