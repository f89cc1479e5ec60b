"""Robots that record what they measure, and walks for them to follow."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
import pytest
from tests.robots import SHIPPED

from biped_description.robot import Robot
from msgs_json.observation import Observation
from msgs_json.segment import WaistSegment
from sim_node.biped import SimulatedBiped
from sim_node.control_tick import ControlTick
from sim_node.engines import ENGINES
from sim_node.settings import DisturbanceSettings, LimitSettings, SimSettings
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

SEGMENTS = 563  # the default walk of 5625 control ticks


@dataclass
class Walker:
    """A simulated biped, with everything it measured since the last `forget`."""

    robot: SimulatedBiped
    rng: np.random.Generator
    ticks: list[ControlTick]

    def walk(self, segments: list[WaistSegment], episode: int = 1) -> list[Observation]:
        """Start a walk; return the observations, that of the standing robot first."""
        return [self.robot.begin_walk(episode), *self.go_on(segments)]

    def go_on(self, segments: list[WaistSegment]) -> list[Observation]:
        """Follow the segments, or those until the walk ends."""
        observations = []
        for segment in segments:
            observations.append(self.robot.execute(segment))
            if observations[-1].end_cause is not None:
                break
        return observations

    def forget(self) -> None:
        self.ticks.clear()

    @property
    def zmp_m(self) -> np.ndarray:
        """(ticks, 2) measured ZMP."""
        return np.array([(t.contact.zmp_x_m, t.contact.zmp_y_m) for t in self.ticks])

    @property
    def joints(self) -> np.ndarray:
        """(3, ticks, 12) positions, velocities and torques."""
        return np.array(
            [
                [tick.joint_position for tick in self.ticks],
                [tick.joint_velocity for tick in self.ticks],
                [tick.joint_torque for tick in self.ticks],
            ]
        )

    @property
    def load_n(self) -> np.ndarray:
        """(ticks,) load on both feet together."""
        contacts = [tick.contact for tick in self.ticks]
        return np.array([each.left_load_n + each.right_load_n for each in contacts])

    @property
    def everything(self) -> np.ndarray:
        """(ticks, ...) all numbers that the ticks carry, for comparison bit by bit."""
        contacts = np.array([(*t.contact, t.zmp_error_m) for t in self.ticks])
        return np.hstack([contacts, *self.joints])


@pytest.fixture(scope="session")
def static_walk() -> list[WaistSegment]:
    """Hand out the default walk without any correction."""
    reference = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings())
    return [reference.segment(np.zeros(2)) for _ in range(SEGMENTS)]


@pytest.fixture(scope="session")
def shaky_walk() -> list[WaistSegment]:
    """Hand out the default walk with random corrections."""
    reference = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings())
    actions = np.random.default_rng(5).uniform(-0.024, 0.024, (SEGMENTS, 2))
    return [reference.segment(action) for action in actions]


@pytest.fixture(scope="session")
def build_walker(static_walk) -> Callable[..., Walker]:
    """Build walkers from limits, disturbances, a seed, a robot and an engine."""

    def build(
        limits: dict | None = None,
        disturbances: dict | None = None,
        seed: int = 0,
        robot: Robot = SHIPPED,
        start: WaistSegment = static_walk[0],
        engine: str = "pybullet",
    ) -> Walker:
        felt = {
            name: value
            for name, value in (disturbances or {}).items()
            if name not in ENGINES[engine].unfelt
        }
        settings = SimSettings(
            engine, LimitSettings(**(limits or {})), DisturbanceSettings(**felt)
        )
        rng = np.random.default_rng(seed)
        ticks = []
        simulated = SimulatedBiped(robot, settings, start, rng, on_tick=ticks.append)
        return Walker(simulated, rng, ticks)

    return build


@pytest.fixture(scope="session")
def engine() -> str:
    """Name the engine that walkers walk on; modules override it to try them all."""
    return "pybullet"


@pytest.fixture
def new_walker(build_walker, engine) -> Iterator[Callable[..., Walker]]:
    """Build walkers that are closed when the test is over."""
    with ExitStack() as stack:

        def build(*args, **kwargs) -> Walker:
            walker = build_walker(*args, engine=engine, **kwargs)
            stack.callback(walker.robot.close)
            return walker

        yield build


@pytest.fixture
def walker(new_walker) -> Walker:
    """Build a robot with default limits and no disturbances."""
    return new_walker()


@pytest.fixture
def sturdy_walker(new_walker) -> Walker:
    """Build a robot that walks on whatever its ZMP error."""
    return new_walker(limits={"zmp_error_m": 1.0})
