"""Limits, faults and disturbances of the simulated robot, with units and ranges."""

from __future__ import annotations

from dataclasses import dataclass

from biped_common.settings import (
    Settings,
    SettingsError,
    section,
    setting,
    to_mapping,
)
from biped_description.settings import RobotSettings
from biped_ros.processor import ProcessorSettings
from sim_node.engines import ENGINES
from sim_node.servo import ServoSettings

ROBOT = "robot"
"""Instead of an engine."""
_FELT_BY_A_PLAYED_ROBOT = ("friction", "torque_limit_factor")
_FELT_BY_NO_ROBOT = (*_FELT_BY_A_PLAYED_ROBOT, "mass_error", "push_force_n")


@dataclass(frozen=True)
class LimitSettings(Settings):
    """What ends a walk, besides the robot's own velocity limit."""

    zmp_error_m: float = setting(
        0.065, "m", "norm of the ZMP error that is a failure (Table 1)", above=0.0
    )
    torque_saturation_s: float = setting(
        0.1, "s", "a joint held at its torque limit this long is a failure", above=0.0
    )
    unloaded_feet_s: float = setting(
        0.05, "s", "no foot carrying load for this long is a failure", above=0.0
    )
    foot_penetration_m: float = setting(
        0.01, "m", "a sole this deep in the floor is a fault of the physics", above=0.0
    )


@dataclass(frozen=True)
class DisturbanceSettings(Settings):
    """Differences between the robot as planned and the robot as it is.

    Random ones are drawn anew for every walk from the generator given to the robot.
    """

    push_force_n: float = setting(
        0.0, "N", "push on the torso's CoM, in a random horizontal direction", lower=0.0
    )
    push_time_s: float = setting(2.0, "s", "when the push begins", lower=0.0)
    push_duration_s: float = setting(0.1, "s", "how long the push lasts", above=0.0)
    friction: float = setting(
        0.9, "", "lateral friction between sole and floor", lower=0.0, upper=10.0
    )
    mass_error: float = setting(
        0.0, "", "std. dev. of each link's relative mass error", lower=0.0, upper=0.3
    )
    position_noise_m: float = setting(
        0.0, "m", "std. dev. of noise on the observed waist position", lower=0.0
    )
    zmp_noise_m: float = setting(
        0.0, "m", "std. dev. of noise on the observed ZMP error", lower=0.0
    )
    acceleration_noise_m_s2: float = setting(
        0.0, "m/s^2", "std. dev. of noise on the observed acceleration", lower=0.0
    )
    torque_limit_factor: float = setting(
        1.0,
        "",
        "share of the joints' torque limits that is there",
        above=0.0,
        upper=1.0,
    )

    @property
    def random(self) -> bool:
        """Whether chance has a part in the walks, so that no two are the same."""
        sizes = (
            self.push_force_n,
            self.mass_error,
            self.position_noise_m,
            self.zmp_noise_m,
            self.acceleration_noise_m_s2,
        )
        return any(size > 0.0 for size in sizes)


@dataclass(frozen=True)
class SensorSettings(Settings):
    """How well a robot's sensors know it, where observations come from them.

    Standard deviations of white noise, per control tick. The defaults are of the order
    of 14-bit encoders, an industrial IMU and six-axis sensors for a robot of 30 kg.
    """

    delay_ticks: int = setting(
        1, "control ticks", "age of the readings that are there", lower=0, upper=10
    )
    joint_position_noise_rad: float = setting(
        2e-4, "rad", "noise on joint positions", lower=0.0
    )
    joint_velocity_noise_rad_s: float = setting(
        0.02, "rad/s", "noise on joint velocities", lower=0.0
    )
    joint_torque_noise_nm: float = setting(
        0.5, "N m", "noise on joint torques", lower=0.0
    )
    orientation_noise_rad: float = setting(
        0.002, "rad", "noise on the torso's orientation, about each axis", lower=0.0
    )
    acceleration_noise_m_s2: float = setting(
        0.05, "m/s^2", "noise on the torso's acceleration", lower=0.0
    )
    force_noise_n: float = setting(
        1.0, "N", "noise on the vertical force on a sole", lower=0.0
    )
    moment_noise_nm: float = setting(
        0.1, "N m", "noise on the moments on a sole", lower=0.0
    )
    tilt_limit_rad: float = setting(
        0.3, "rad", "tilt of the torso at which a walk ends", above=0.0, upper=1.5
    )
    timeout_s: float = setting(
        0.05, "s", "silence of a real robot's sensors at which a walk ends", above=0.0
    )
    following_limit_rad: float = setting(
        0.05,
        "rad",
        "from a real robot's joint to where it was asked to be, at which a walk ends",
        above=0.0,
        upper=1.5,
    )

    @property
    def noisy(self) -> bool:
        """Whether chance has a part in the readings."""
        sizes = (
            self.joint_position_noise_rad,
            self.joint_velocity_noise_rad_s,
            self.joint_torque_noise_nm,
            self.orientation_noise_rad,
            self.acceleration_noise_m_s2,
            self.force_noise_n,
            self.moment_noise_nm,
        )
        return any(size > 0.0 for size in sizes)


@dataclass(frozen=True)
class SimSettings(Settings):
    """The simulated robot."""

    engine: str = setting(
        "pybullet",
        "",
        "pybullet, mujoco: full physics; kinematic: joints on their references; "
        "robot: a real one, on ros2_control's topics",
        choices=(*ENGINES, ROBOT),
    )
    limits: LimitSettings = section(LimitSettings)
    disturbances: DisturbanceSettings = section(DisturbanceSettings)
    servo: ServoSettings = section(ServoSettings)
    observations: str = setting(
        "truth",
        "",
        "truth: as the engine knows the robot; sensors: as its sensors do",
        choices=("truth", "sensors"),
    )
    sensors: SensorSettings = section(SensorSettings)

    @property
    def random(self) -> bool:
        """Whether chance has a part in the walks, so that no two are the same."""
        sensed = self.observations == "sensors" and self.sensors.noisy
        return self.disturbances.random or sensed or self.engine == ROBOT

    def check_together(self) -> None:
        """Refuse servos that there are not, and disturbances without effect."""
        if self.engine != ROBOT:
            servos, unfelt = ENGINES[self.engine].servos, ENGINES[self.engine].unfelt
        elif self.observations == "sensors":
            servos, unfelt = (ServoSettings().kind,), _FELT_BY_NO_ROBOT
        else:
            raise SettingsError(
                "observations",
                self.observations,
                "must be sensors with engine = robot",
            )
        if self.servo.kind not in servos:
            problem = f"must be one of {', '.join(servos)} with engine = {self.engine}"
            raise SettingsError("servo.kind", self.servo.kind, problem)
        for name in unfelt:
            value = getattr(self.disturbances, name)
            nominal = getattr(DisturbanceSettings(), name)
            if value != nominal:
                raise SettingsError(
                    f"disturbances.{name}",
                    value,
                    f"must be {nominal}: it has no effect with engine = {self.engine}",
                )


@dataclass(frozen=True)
class SimNodeSettings(Settings):
    """All of the simulation node."""

    robot: RobotSettings = section(RobotSettings)
    sim: SimSettings = section(SimSettings)
    processor: ProcessorSettings = section(ProcessorSettings)
    seed: int = setting(0, "", "of the disturbances", lower=0, upper=2**63 - 1)
    pace: str = setting(
        "lockstep",
        "",
        "lockstep: as fast as all can; realtime: 500 Hz, waiting for nobody",
        choices=("lockstep", "realtime"),
    )
    realtime_factor: float = setting(
        1.0,
        "",
        "simulated seconds per second, in real time",
        above=0.0,
        upper=20.0,
        live=True,
    )
    publish_every_ticks: int = setting(
        1,
        "control ticks",
        "1 publishes at 500 Hz, 10 at 50 Hz",
        lower=1,
        upper=1000,
        live=True,
    )
    markers_every_ticks: int = setting(
        20,
        "control ticks",
        "20 publishes markers and torso pose at 25 Hz; 0: never",
        lower=0,
        upper=1000,
        live=True,
    )
    timeout_s: float = setting(
        5.0,
        "s",
        "silence of a peer after which a walk is given up",
        above=0.0,
        live=True,
    )
    recorders: int = setting(
        0,
        "",
        "recorders to wait for, timeout_s at most, before the first walk",
        lower=0,
        upper=10,
    )

    def check_together(self) -> None:
        """Refuse a pace of the simulation's own where a robot keeps the time."""
        if self.sim.engine == ROBOT and self.pace != "lockstep":
            raise SettingsError(
                "pace",
                self.pace,
                f"must be lockstep with sim.engine = {ROBOT}, which keeps its own time",
            )


@dataclass(frozen=True)
class HardwareNodeSettings(Settings):
    """All of the node that plays a robot's motors and sensors."""

    robot: RobotSettings = section(RobotSettings)
    sim: SimSettings = section(SimSettings)
    seed: int = setting(0, "", "of the sensors' noise", lower=0, upper=2**63 - 1)
    pace: str = setting(
        "realtime",
        "",
        "realtime: 500 Hz, whatever comes; lockstep: 20 ms for every trajectory",
        choices=("realtime", "lockstep"),
    )
    realtime_factor: float = setting(
        1.0, "", "simulated seconds per second, in real time", above=0.0, upper=20.0
    )

    def check_together(self) -> None:
        """Refuse to play a real robot on a real robot, and what has no effect here."""
        if self.sim.engine == ROBOT:
            raise SettingsError("sim.engine", ROBOT, "must be one that simulates")
        for name, nominal in to_mapping(DisturbanceSettings()).items():
            value = getattr(self.sim.disturbances, name)
            if value != nominal and name not in _FELT_BY_A_PLAYED_ROBOT:
                raise SettingsError(
                    f"sim.disturbances.{name}",
                    value,
                    f"must be {nominal}: it has no effect on a robot that is played",
                )
