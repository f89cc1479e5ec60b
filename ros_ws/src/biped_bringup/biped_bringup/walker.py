"""A walk in one process: learner, trajectory and robot, tick by tick, without ROS."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from biped_bringup.run_settings import RunSettings
from biped_common.settings import SettingsError
from biped_description.robot import Robot
from msgs_json.episode_result import EpisodeResult
from msgs_json.observation import Observation
from sim_node.biped import SimulatedBiped
from sim_node.control_tick import ControlTick
from sim_node.settings import ROBOT
from trajectory_node.waist_reference import WaistReference


class Responder(Protocol):
    """Whoever answers observations: a learner, or a frozen walk."""

    def respond(self, observation: Observation) -> NDArray[np.float64] | EpisodeResult:
        """Return the correction [m] for the coming learning tick, or the result."""


@dataclass
class WalkedTicks:
    """Where the control ticks of all walks came from."""

    computed: int = 0
    """Steps of the physics, those executed again for a replay included."""
    replayed: int = 0
    """Known from earlier walks instead."""

    @property
    def replayed_share(self) -> float:
        """Share of the replayed ones, 0 before the first tick."""
        return self.replayed / max(1, self.computed + self.replayed)


class Walker:
    """The robot and its reference, for one walk after the other."""

    def __init__(
        self,
        settings: RunSettings,
        rng: np.random.Generator,
        on_tick: Callable[[ControlTick], None] | None = None,
    ) -> None:
        """Plan the gait and build the world.

        Args:
            settings: of the whole run.
            rng: source of the disturbances.
            on_tick: called after every control tick.
        """
        robot = Robot(settings.robot)
        self.reference = WaistReference(robot, settings.gait, settings.correction)
        self.biped = SimulatedBiped(
            robot, settings.sim, self.reference.stance(), rng, on_tick
        )
        self.ticks = WalkedTicks()
        self._walks = 0

    @property
    def walk_ticks(self) -> int:
        """Control ticks of the whole walk."""
        return self.reference.ticks

    def walk(self, responder: Responder) -> EpisodeResult:
        """Walk until the responder gives a result.

        Raises:
            SettingsError: the robot is a real one, which nodes walk.
        """
        if self.biped.settings.engine == ROBOT:
            problem = "must be a simulated one here; a real one is walked by `biped up`"
            raise SettingsError("sim.engine", ROBOT, problem)
        self._walks += 1
        self.reference.reset()
        answer = responder.respond(self.biped.begin_walk(self._walks))
        while not isinstance(answer, EpisodeResult):
            observation = self.biped.execute(self.reference.segment(answer))
            answer = responder.respond(observation)
        self.ticks.computed += self.biped.control_tick
        return answer

    def close(self) -> None:
        """End the world."""
        self.biped.close()
