"""The plant of a walk, as the settings want it: an engine, and who tells of it."""

from __future__ import annotations

import importlib

import numpy as np

from biped_description.robot import Robot
from sim_node.engines import plant_of
from sim_node.physics import Array, Physics
from sim_node.sensed_world import Hardware, SensedWorld
from sim_node.settings import ROBOT, SimSettings
from sim_node.simulated_hardware import SimulatedHardware


def make_plant(
    robot: Robot,
    settings: SimSettings,
    torque_limits_nm: Array,
    rng: np.random.Generator,
) -> Physics:
    """Build an engine's plant; where it is known by its sensors, an observer for it.

    Args:
        robot: that stands in it.
        settings: engine, friction, servos and sensors.
        torque_limits_nm: (12,) that the servos can reach.
        rng: of the sensors' noise.

    Raises:
        EngineMissingError: what the engine needs is not installed.
    """
    sensors = settings.sensors
    if settings.engine == ROBOT:
        # Loaded only where it is wanted: nothing else here needs ROS.
        module = importlib.import_module("sim_node.robot_hardware")
        real: Hardware = module.RobotHardware(robot, sensors)
        return SensedWorld(robot, real, sensors.tilt_limit_rad)
    friction, servo = settings.disturbances.friction, settings.servo
    plant = plant_of(settings.engine)(robot, friction, torque_limits_nm, servo)
    if settings.observations == "truth":
        return plant
    hardware = SimulatedHardware(plant, robot, sensors, rng)
    return SensedWorld(robot, hardware, sensors.tilt_limit_rad)
