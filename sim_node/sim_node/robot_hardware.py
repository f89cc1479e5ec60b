"""A real robot's motors and sensors, on the topics of ros2_control.

Nobody can put a real robot back on its feet but a person: a walk begins when somebody
has called `/robot_hardware/begin`, holding it. The joints then go to the stance slowly,
and the robot must stand there by itself.

What failures do:
    the sensors are silent for longer than the time-out, or read what is no number; the
        emergency stop is pressed: the walk ends, and nothing is commanded any more. A
        position controller holds where it was told to be last; what the motors do at an
        emergency stop, and without commands, is the robot's own matter.
    the robot does not stand when the walk is to begin: no walk.
"""

from __future__ import annotations

import threading
from functools import partial
from typing import Any

import numpy as np
import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Bool, Float64MultiArray
from std_srvs.srv import Trigger

from biped_common.timing import CONTROL_PERIOD_S, CONTROL_PERIOD_US, microseconds
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from sim_node.errors import PlantStoppedError
from sim_node.physics import Array, Vector
from sim_node.sensed_world import Hardware
from sim_node.sensor_intake import SensorIntake
from sim_node.sensors import SensorReading

NAME = "robot_hardware"
_TURN_S = 0.2
_FIRST_S = 1.0
"""For the sensors to be heard of before a walk."""
# From where the joints are to the stance, and standing there.
_TO_STANCE_TICKS = microseconds(2.0) // CONTROL_PERIOD_US
_STANDING_TICKS = microseconds(0.5) // CONTROL_PERIOD_US
# What standing is: each sole's share of the weight, and how far a joint may be off.
_SHARE = 0.2
_OFF_RAD = 0.05
_STANDING = 0


class RobotHardware(Hardware):
    """See `Hardware`. Joins the graph when it is asked for the first time."""

    def __init__(self, robot: Robot, timeout_s: float) -> None:
        """Take note of the robot.

        Args:
            robot: as it is planned with.
            timeout_s: silence of the sensors that ends a walk.
        """
        self._weight_n = robot.mass_kg * GRAVITY_M_S2
        self._timeout_s = timeout_s
        self._stance = np.empty(0)
        self._intake = SensorIntake()
        self._changed = threading.Condition()
        self._begun = False
        """Somebody has asked for the next walk."""
        self._walked = False
        """The robot has been driven; before, it is taken to stand as it is asked to."""
        self._stop = False
        self._context: Any = None

    # -- hardware ------------------------------------------------------------------

    def ready(self) -> bool:
        """Return whether somebody has asked for the next walk."""
        self._join()
        return self._begun

    def place(self, waist: Array, q: Array) -> None:
        """Take note of the stance; the robot gets there when a walk begins."""
        del waist
        self._stance = q

    def exchange(self, q: Array, dq: Array) -> SensorReading:
        """Command the joints; wait for the next readings.

        Raises:
            PlantStoppedError: they do not come, or the emergency stop is pressed.
        """
        if not self._walked:
            return self._taken_to_stand(q)
        return self._command(q + CONTROL_PERIOD_S * dq)

    def push(self, force_n: Vector) -> None:
        """Do nothing: a real robot is pushed by hand."""

    def set_mass_factors(self, factors: Array) -> None:
        """Do nothing: a real robot weighs what it weighs."""

    def save(self) -> int:
        """Return the handle of the stance, the only state that there is."""
        return _STANDING

    def load(self, handle: int) -> None:
        """Wait until somebody asks for it, and have the robot stand in its stance.

        Raises:
            PlantStoppedError: the walk cannot begin.
        """
        del handle
        self._join()
        with self._changed:
            if not self._begun:
                self._node.get_logger().info(f"waiting for a call of /{NAME}/begin")
            self._changed.wait_for(lambda: self._begun)
            self._begun = False
        self._walked = True
        # From where the joints are now, not where they were when last heard of.
        reading = self._wait(self._intake.complete, _FIRST_S)
        start = reading.joints[: len(self._stance)]
        for tick in range(1, _TO_STANCE_TICKS + 1):
            s = tick / _TO_STANCE_TICKS
            # The path of least jerk: at rest at both ends.
            share = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
            self._command(start + share * (self._stance - start))
        for _ in range(_STANDING_TICKS):
            reading = self._command(self._stance)
        off_rad = abs(reading.joints[: len(self._stance)] - self._stance).max()
        if not (
            off_rad < _OFF_RAD and reading.soles[:, 0].min() > _SHARE * self._weight_n
        ):
            raise PlantStoppedError(EndCause.NOT_STANDING)

    def release(self, handle: int) -> None:
        """Do nothing; the stance stays."""

    def close(self) -> None:
        """Leave the graph; harmless when repeated."""
        if self._context is not None:
            self._closing.set()
            self._thread.join()
            self._node.destroy_node()
            rclpy.shutdown(context=self._context)
            self._context = None

    # -- commands and readings -----------------------------------------------------

    def _command(self, positions: Array) -> SensorReading:
        if not np.isfinite(positions).all():
            raise PlantStoppedError(EndCause.PHYSICS_NAN)
        if self._stop:
            raise PlantStoppedError(EndCause.EMERGENCY_STOP)
        seen = self._intake.complete
        self._commands.publish(Float64MultiArray(data=positions.tolist()))
        return self._wait(seen, self._timeout_s)

    def _wait(self, seen: int, timeout_s: float) -> SensorReading:
        """Return the newest reading, once there are more than were seen."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._stop or self._intake.complete > seen, timeout_s
            )
            reading = self._intake.newest
            if self._stop:
                raise PlantStoppedError(EndCause.EMERGENCY_STOP)
            if reading is None or self._intake.complete <= seen:
                raise PlantStoppedError(EndCause.SENSORS_SILENT)
        if not reading.usable:
            raise PlantStoppedError(EndCause.SENSORS_INVALID)
        return reading

    def _taken_to_stand(self, q: Array) -> SensorReading:
        half = [0.5 * self._weight_n, 0.0, 0.0]
        return SensorReading(
            np.concatenate([q, np.zeros(2 * len(q))]),
            np.array([0.0, 0.0, 0.0, 1.0]),
            np.array([0.0, 0.0, GRAVITY_M_S2]),
            np.array([half, half]),
        )

    # -- graph ---------------------------------------------------------------------

    def _join(self) -> None:
        """Join the graph of ROS_DOMAIN_ID, in a context of its own.

        Its callbacks run in a thread of their own, since who walks waits for them.
        """
        if self._context is not None:
            return
        self._context = rclpy.Context()
        rclpy.init(context=self._context)
        self._node = node = Node(NAME, context=self._context)
        left, right = topics.HARDWARE_SOLES
        for topic, handle in (
            (topics.HARDWARE_JOINTS, self._intake.joint_states),
            (topics.HARDWARE_IMU, self._intake.imu),
            (left, partial(self._intake.sole, 0)),
            (right, partial(self._intake.sole, 1)),
            (topics.EMERGENCY_STOP, self._on_emergency_stop),
        ):
            node.create_subscription(
                message_type(topic),
                topic.name,
                partial(self._arrived, handle),
                qos_profile(topic),
            )
        commands = topics.HARDWARE_COMMANDS
        self._commands = node.create_publisher(
            message_type(commands), commands.name, qos_profile(commands)
        )
        node.create_service(Trigger, f"{NAME}/begin", self._on_begin)
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=NAME, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        executor = EventsExecutor(context=self._context)
        executor.add_node(self._node)
        never: Future = Future()
        while not self._closing.is_set():
            executor.spin_until_future_complete(never, timeout_sec=_TURN_S)
        executor.shutdown()

    def _arrived(self, handle: Any, message: Any) -> None:
        with self._changed:
            handle(message)
            self._changed.notify_all()

    def _on_emergency_stop(self, message: Bool) -> None:
        self._stop = message.data

    def _on_begin(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        with self._changed:
            if self._stop:
                response.message = "the emergency stop is pressed"
            elif self._intake.newest is None:
                response.message = "not all sensors have been heard yet"
            else:
                self._begun = response.success = True
                response.message = "the joints go to the stance; hold the robot"
                self._changed.notify_all()
        return response
