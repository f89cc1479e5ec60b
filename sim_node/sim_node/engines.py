"""The physics engines there are, loaded only when they are wanted."""

from __future__ import annotations

import importlib
from typing import Final, NamedTuple

from sim_node.errors import EngineMissingError
from sim_node.physics import Physics
from sim_node.servo import SERVO_KINDS


class Engine(NamedTuple):
    """Where an engine is, and what it cannot do."""

    module: str
    plant: str
    """Name of its class in the module, a `Physics`."""
    extra: str = ""
    """Of the project, that brings what the module imports."""
    unfelt: tuple[str, ...] = ()
    """Disturbances that have no effect on it."""
    servos: tuple[str, ...] = ("ideal",)
    """Kinds of servos that it has."""


ENGINES: Final = {
    "pybullet": Engine(
        "sim_node.pybullet_world", "PyBulletWorld", servos=tuple(SERVO_KINDS)
    ),
    "mujoco": Engine(
        "sim_node.mujoco_world",
        "MuJoCoWorld",
        extra="mujoco",
        servos=tuple(SERVO_KINDS),
    ),
    "kinematic": Engine(
        "sim_node.kinematic_world",
        "KinematicWorld",
        unfelt=("friction", "torque_limit_factor"),
    ),
}


def plant_of(engine: str) -> type[Physics]:
    """Return the plant of an engine, to be built.

    Raises:
        EngineMissingError: what it needs is not installed.
    """
    found = ENGINES[engine]
    try:
        module = importlib.import_module(found.module)
    except ImportError as error:
        needs = f"it needs pip install 'biped[{found.extra}]'; " if found.extra else ""
        raise EngineMissingError(
            f"sim.engine = {engine!r}: cannot be loaded, {error}; {needs}"
            "kinematic needs nothing"
        ) from error
    plant: type[Physics] = getattr(module, found.plant)
    return plant
