"""A real robot's motors and sensors, on the topics of ros2_control.

Nobody can put a real robot back on its feet but a person: a walk begins when somebody
has called `/robot_hardware/begin`, holding it, between two walks and a few seconds
before. The joints then go to the stance slowly, and the robot must stand there by
itself.

The robot keeps the time: control ticks are counted by the stamps of its readings. It
is sent each segment with its look-ahead, stamped with the reading that the segment
answers, and walks on along the look-ahead until the next one comes.

What failures do:
    the emergency stop is pressed, if only for a moment: the joints are asked to stay
        at once, the walk ends, and whoever has asked for one has to ask again. What the
        motors do at an emergency stop, and without commands, is the robot's own matter.
    the sensors read what is no number; a joint is not where it was asked to be; a
        segment comes more than 30 ms after the reading that it answers; the walk is
        ended by whoever guides it: it ends, and the joints are asked to stay.
    the sensors are silent for longer than the time-out: the walk ends. Nobody knows any
        more where the joints are to stay; they come to rest where the look-ahead ends.
    the robot does not stand when the walk is to begin: no walk.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import rclpy
from rclpy.duration import Duration
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from std_msgs.msg import Bool
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from biped_common.timing import (
    CONTROL_PERIOD_NS,
    TICKS_PER_LEARNING_TICK,
    control_ticks,
)
from biped_description.joints import JOINT_NAMES
from biped_description.multilink_zmp import GRAVITY_M_S2
from biped_description.robot import Robot
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from sim_node.errors import PlantStoppedError, SnapshotError
from sim_node.physics import Array, Vector
from sim_node.sensed_world import Hardware
from sim_node.sensor_intake import SensorIntake
from sim_node.sensors import SensorReading
from sim_node.sent_trajectory import LEAST_LOOK_AHEAD_TICKS, SentTrajectory
from sim_node.settings import SensorSettings

NAME = "robot_hardware"
_TURN_S = 0.2
_FIRST_S = 1.0
"""For the sensors to be heard of before a walk."""
_ASKED_S = 10.0
"""A person who has asked for a walk is taken to hold the robot for so long."""
# From where the joints are to the stance, and standing there.
_TO_STANCE_TICKS = control_ticks(2.0)
_STANDING_TICKS = control_ticks(0.5)
_LATE_TICKS = control_ticks(0.03)
"""From a reading until what answers it has to be sent."""
_SHARE = 0.2
"""Of the weight, on each sole of a robot that stands."""
_STANDING = 0
_KEPT_READINGS = 500


class RobotHardware(Hardware):
    """See `Hardware`. Joins the graph when it is asked for the first time."""

    def __init__(self, robot: Robot, limits: SensorSettings) -> None:
        """Take note of the robot.

        Args:
            robot: as it is planned with.
            limits: silence and joint errors that end a walk; noise is the robot's own.
        """
        self._weight_n = robot.mass_kg * GRAVITY_M_S2
        self._limits = limits
        self._stance = np.empty(0)
        self._intake = SensorIntake()
        self._changed = threading.Condition()
        self._asked_s: float | None = None
        """When somebody has asked for the next walk, on the monotonic clock."""
        self._under_way = False
        """A walk, or the way to the stance."""
        self._walked = False
        """The robot has been driven; before, it is taken to stand as it is asked to."""
        self._pressed = False
        """The emergency stop, now."""
        self._stopped = False
        """It was pressed since the walk was asked for."""
        self._readings: deque[tuple[int, SensorReading]] = deque(maxlen=_KEPT_READINGS)
        """Stamp [ns] and values, of all ticks that are still to be walked."""
        self._origin_ns: int | None = None
        """Stamp that ticks are counted from; None: that of the next segment."""
        self._tick = 0
        """Control ticks walked since then."""
        self._sent = SentTrajectory()
        self._late = False
        self._context: Any = None

    # -- hardware ------------------------------------------------------------------

    def ready(self) -> bool:
        """Return whether somebody has asked for the next walk; the last one is over."""
        self._join()
        with self._changed:
            self._under_way = False
            return self._asked()

    def place(self, waist: Array, q: Array) -> None:
        """Take note of the stance; the robot gets there when a walk begins."""
        del waist
        self._stance = q

    def plan(self, positions: Array) -> None:
        """Send the joints on their way: (ticks, 12) positions, tick by tick [rad].

        The first way since a walk began starts now; the robot has stood till then.
        """
        with self._changed:
            if self._origin_ns is None:
                self._origin_ns, self._tick = self._intake.stamp_ns, 0
                self._sent.forget()
            ahead = self._tick_of(self._intake.stamp_ns) - self._tick
            self._late = ahead > _LATE_TICKS
            if not (self._late or self._stopped):
                self._send(self._tick, self._sent.next(self._tick, positions))

    def exchange(self, q: Array, dq: Array) -> SensorReading:
        """Wait for the readings after the next control tick of what was planned.

        Raises:
            PlantStoppedError: they do not come, or tell of joints that do not follow;
                the plan came late; or the emergency stop is pressed.
        """
        del dq
        if not self._walked:
            return self._taken_to_stand(q)
        self._tick += 1
        with self._changed:
            self._changed.wait_for(
                lambda: self._stopped or self._arrived(), self._limits.timeout_s
            )
            if self._stopped:
                cause = EndCause.EMERGENCY_STOP
            elif self._late:
                cause = EndCause.LATE
            elif not self._arrived():
                cause = EndCause.SENSORS_SILENT
            elif not self._readings[0][1].usable:
                cause = EndCause.SENSORS_INVALID
            elif not self._follows(*self._readings[0]):
                cause = EndCause.NOT_FOLLOWING
            else:
                return self._readings[0][1]
            if cause is not EndCause.SENSORS_SILENT:
                self._hold()
            self._under_way = False
        raise PlantStoppedError(cause)

    def stop(self) -> None:
        """Have the joints stay, if a walk is under way."""
        with self._changed:
            self._hold()
            self._under_way = False

    def push(self, force_n: Vector) -> None:
        """Do nothing: a real robot is pushed by hand."""

    def set_mass_factors(self, factors: Array) -> None:
        """Do nothing: a real robot weighs what it weighs."""

    def save(self) -> int:
        """Return the handle of the stance, the only state that there is.

        Raises:
            SnapshotError: the robot has walked since; nobody can put it back there.
        """
        if self._walked:
            raise SnapshotError("a real robot can be put back into its stance only")
        return _STANDING

    def load(self, handle: int) -> Sequence[SensorReading]:
        """Wait until somebody asks for it, and have the robot stand in its stance.

        Returns:
            What was read while it stood there.

        Raises:
            PlantStoppedError: the walk cannot begin.
        """
        del handle
        self._join()
        with self._changed:
            self._under_way = False
            if not self._asked():
                self._node.get_logger().info(f"waiting for a call of /{NAME}/begin")
            self._changed.wait_for(self._asked)
            self._asked_s, self._under_way, self._stopped = None, True, False
            self._sent.forget()  # a stop must not lead to where the last walk ended
        self._walked = True
        stood = self._go_to_stance(self._newest().joints[: len(self._stance)])
        if not stood[-1].soles[:, 0].min() > _SHARE * self._weight_n:
            self.stop()
            raise PlantStoppedError(EndCause.NOT_STANDING)
        return stood

    def release(self, handle: int) -> None:
        """Do nothing; the stance stays."""

    def close(self) -> None:
        """Leave the graph; harmless when repeated."""
        if self._context is not None:
            self.stop()
            self._closing.set()
            self._thread.join()
            self._node.destroy_node()
            rclpy.shutdown(context=self._context)
            self._context = None

    # -- commands and readings -----------------------------------------------------

    def _asked(self) -> bool:
        """Return whether somebody has asked for a walk a moment ago."""
        asked_s = self._asked_s
        return asked_s is not None and time.monotonic() - asked_s < _ASKED_S

    def _newest(self) -> SensorReading:
        """Return what is read from now on, not what was heard of last.

        Raises:
            PlantStoppedError: the sensors are silent, or read what is no number.
        """
        with self._changed:
            seen = self._intake.complete
            self._changed.wait_for(lambda: self._intake.complete > seen, _FIRST_S)
            reading = self._intake.newest
            if reading is None or self._intake.complete == seen:
                raise PlantStoppedError(EndCause.SENSORS_SILENT)
        if not reading.usable:
            raise PlantStoppedError(EndCause.SENSORS_INVALID)
        return reading

    def _go_to_stance(self, start: Array) -> list[SensorReading]:
        """Lead the (12,) joints to the stance; return the readings of standing there.

        Raises:
            PlantStoppedError: it cannot go on.
        """
        # The path of least jerk: at rest at both ends.
        s = np.arange(1, _TO_STANCE_TICKS + 1)[:, None] / _TO_STANCE_TICKS
        share = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
        stands = np.tile(self._stance, (_STANDING_TICKS + LEAST_LOOK_AHEAD_TICKS, 1))
        way = np.vstack([start + share * (self._stance - start), stands])
        self._origin_ns = None
        readings = []
        for tick in range(
            0, len(way) - LEAST_LOOK_AHEAD_TICKS, TICKS_PER_LEARNING_TICK
        ):
            self.plan(
                way[tick : tick + TICKS_PER_LEARNING_TICK + LEAST_LOOK_AHEAD_TICKS]
            )
            for _ in range(TICKS_PER_LEARNING_TICK):
                readings.append(self.exchange(self._stance, np.zeros(0)))
        self._origin_ns = None
        return readings[-_STANDING_TICKS:]

    def _send(self, tick: int, positions: Array) -> None:
        """Have the joints follow (ticks, 12) positions from after a tick on."""
        stamp_ns = (self._origin_ns or 0) + tick * CONTROL_PERIOD_NS
        message = JointTrajectory(joint_names=list(JOINT_NAMES))
        message.header.stamp = Time(nanoseconds=stamp_ns).to_msg()
        message.points = [
            JointTrajectoryPoint(
                positions=row,
                time_from_start=Duration(nanoseconds=i * CONTROL_PERIOD_NS).to_msg(),
            )
            for i, row in enumerate(positions.tolist(), start=1)
        ]
        self._commands.publish(message)

    def _hold(self) -> None:
        """Have the joints stay where they are asked to be in a moment, if they move."""
        if self._under_way:
            now = self._tick_of(self._intake.stamp_ns)
            staying = self._sent.stay(now)
            if staying is not None:
                self._send(now, staying)

    def _tick_of(self, stamp_ns: int) -> int:
        """Return the control tick, since a walk's first, that a stamp belongs to."""
        return round((stamp_ns - (self._origin_ns or 0)) / CONTROL_PERIOD_NS)

    def _arrived(self) -> bool:
        """Return whether the readings after the present tick have come, or later ones.

        Those of one that was lost are taken from the next.
        """
        readings = self._readings
        while readings and self._tick_of(readings[0][0]) < self._tick:
            readings.popleft()
        return bool(readings)

    def _follows(self, stamp_ns: int, reading: SensorReading) -> bool:
        """Return whether all joints were read near where they had been asked to be."""
        asked = self._sent.asked(self._tick_of(stamp_ns))
        if asked is None:
            return True
        off_rad = abs(reading.joints[: len(asked)] - asked).max()
        return bool(off_rad < self._limits.following_limit_rad)

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
                partial(self._take, handle),
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

    def _take(self, handle: Any, message: Any) -> None:
        with self._changed:
            seen = self._intake.complete
            handle(message)
            if self._intake.complete > seen and self._intake.newest is not None:
                self._readings.append((self._intake.stamp_ns, self._intake.newest))
                self._changed.notify_all()

    def _on_emergency_stop(self, message: Bool) -> None:
        with self._changed:
            self._pressed = message.data
            if self._pressed:
                self._stopped, self._asked_s = True, None
                self._hold()
            self._changed.notify_all()

    def _on_begin(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        with self._changed:
            if self._pressed:
                response.message = "the emergency stop is pressed"
            elif self._under_way:
                response.message = "a walk is under way"
            elif self._intake.newest is None:
                response.message = "not all sensors have been heard yet"
            elif self._commands.get_subscription_count() == 0:
                topic = topics.HARDWARE_COMMANDS.name
                response.message = f"nobody listens to {topic}"
            else:
                self._asked_s, response.success = time.monotonic(), True
                response.message = "the joints go to the stance; hold the robot"
                self._changed.notify_all()
        return response
