"""The whole environment tick against bare `stepSimulation`, on the same motion.

Two robots walk the static walk, limits out of the way, and take turns of a fifth of a
simulated second: one as the learner has it, the other told by hand what the first one's
servos were told, with the time inside `step` alone taken. For every learning tick the
median over the walks counts, so that neither a drift of the machine's speed nor what
else runs on it gets into the ratio.
"""

from __future__ import annotations

import time
from typing import cast

import numpy as np
from numpy.typing import NDArray

from benchmarks.report import Figure
from biped_bringup.run_settings import RunSettings
from biped_bringup.walker import Walker
from biped_common.settings import from_mapping
from biped_common.timing import CONTROL_PERIOD_S, TICKS_PER_LEARNING_TICK
from learner_node.walking.walks import FrozenWalk, static_walk
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from sim_node.bullet_kernels import command_servos, step_physics
from sim_node.control_tick import ControlTick
from sim_node.pybullet_world import PyBulletWorld

_WALKS = 9
_TURN = 10  # learning ticks
_RATIO_BOUND = 1.3

Command = tuple[NDArray[np.float64], NDArray[np.float64]]


def measure() -> list[Figure]:
    """Return microseconds per control tick and the ratio."""
    settings = from_mapping(RunSettings, {"sim": {"limits": {"zmp_error_m": 1.0}}})
    commands = _recorded_commands(settings)
    walker, bare = (Walker(settings, np.random.default_rng(0)) for _ in range(2))
    whole_s, bare_s = [], []
    for _ in range(_WALKS):
        turns = _Turns(static_walk(settings.learner, walker.walk_ticks), bare, commands)
        walker.walk(turns)
        whole_s.append(turns.whole_s)
        bare_s.append(turns.bare_s)
    walker.close()
    bare.close()
    whole_us, bare_us = (1e6 * _per_tick_s(times) for times in (whole_s, bare_s))
    return [
        Figure("stepSimulation alone, per control tick", bare_us, "us"),
        Figure("whole environment, per control tick", whole_us, "us"),
        Figure(
            "whole environment / stepSimulation", whole_us / bare_us, "", _RATIO_BOUND
        ),
        Figure("simulated seconds per second", 2000.0 / whole_us, ""),
    ]


def _per_tick_s(times_s: list[list[float]]) -> float:
    """Return the time per control tick, from that of (walks, learning ticks)."""
    return float(np.median(times_s, axis=0).mean()) / TICKS_PER_LEARNING_TICK


class _Turns:
    """Answers a walk's observations, and lets the bare engine catch up now and then."""

    def __init__(
        self, answers: FrozenWalk, bare: Walker, commands: list[Command]
    ) -> None:
        self._answers = answers
        self._bare = bare.biped
        self._bare.begin_walk(episode=1)
        self._commands = iter(commands)
        self._resumed = 0.0
        self.whole_s: list[float] = []
        self.bare_s: list[float] = []
        """Per learning tick, like `whole_s`."""

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Take the time of the learning tick that is over, and answer."""
        whole = observation.control_tick % TICKS_PER_LEARNING_TICK == 0
        if observation.control_tick > 0 and whole:
            self.whole_s.append(time.perf_counter() - self._resumed)
            if len(self.whole_s) % _TURN == 0:
                self.bare_s.extend(self._bare_tick_s() for _ in range(_TURN))
        self._resumed = time.perf_counter()
        return self._answers.respond(observation)

    def _bare_tick_s(self) -> float:
        world, spent = cast(PyBulletWorld, self._bare.world), 0.0
        robot = (
            world.client,
            world.robot,
            world.joint_numbers,
            world.torque_limits_nm,
            world.servo_shares,
        )
        for _ in range(TICKS_PER_LEARNING_TICK):
            command_servos(*robot, *next(self._commands))
            start = time.perf_counter()
            step_physics(world.client)
            spent += time.perf_counter() - start
        return spent


def _recorded_commands(settings: RunSettings) -> list[Command]:
    """Walk once and return what the servos were told; compiles everything, too."""
    references: list[list[float]] = []

    def record(tick: ControlTick) -> None:
        references.append(tick.joint_reference)

    walker = Walker(settings, np.random.default_rng(0), record)
    walker.walk(static_walk(settings.learner, walker.walk_ticks))
    walker.close()
    positions = np.array(references)
    velocities = np.diff(positions, axis=0) / CONTROL_PERIOD_S
    return list(zip(positions[:-1], velocities, strict=True))
