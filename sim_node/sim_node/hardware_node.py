"""Plays a robot's motors and sensors: an engine behind the topics of ros2_control.

    python -m sim_node.hardware_node --ros-args -p pace:=realtime

It publishes what the broadcasters of a controller manager publish, and follows what a
joint_trajectory_controller follows; nothing else of it is on the graph. Standing in for
the person who puts a robot back on its feet: the service `/simulated_hardware/reset`.
"""

from __future__ import annotations

import sys
import time
from typing import Any

import numpy as np
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory

from biped_common.seeds import robot_stream
from biped_common.timing import (
    CONTROL_PERIOD_NS,
    CONTROL_PERIOD_S,
    TICKS_PER_LEARNING_TICK,
)
from biped_description.joints import JOINT_NAMES
from biped_description.links import CONTACT_LINKS, TORSO
from biped_description.robot import Robot
from biped_ros.guarded import GuardedNode
from biped_ros.messages import (
    imu_template,
    joint_state_template,
    message_type,
    wrench_template,
)
from biped_ros.qos import qos_profile
from biped_ros.running import run_node
from msgs_json import topics
from msgs_json.wire import RefusedMessageError
from sim_node.engines import plant_of
from sim_node.followed_trajectory import FollowedTrajectory
from sim_node.settings import HardwareNodeSettings
from sim_node.simulated_hardware import SimulatedHardware

NAME = "simulated_hardware"
_SETTLING_TICKS = 150
# In lockstep, after so long without a trajectory, sensors are heard again: time stands
# still for the robot, but it must not seem dead.
_IDLE_S = 0.5
_MADE_UP_TICKS = 5
"""Control ticks that a late timer makes up for."""


class HardwareNode(GuardedNode):
    """The robot stands on straight legs, until it is told otherwise."""

    def __init__(self, **options: Any) -> None:
        """Build the plant, and put the robot on its feet.

        Args:
            options: of `rclpy.node.Node`.
        """
        super().__init__(NAME, **options)
        settings = self.settings_from_parameters(HardwareNodeSettings)
        robot = Robot(settings.robot)
        disturbances = settings.sim.disturbances
        plant = plant_of(settings.sim.engine)(
            robot,
            disturbances.friction,
            robot.torque_limit_nm * disturbances.torque_limit_factor,
            settings.sim.servo,
        )
        rng = np.random.default_rng(robot_stream(settings.seed))
        self._hardware = SimulatedHardware(plant, robot, settings.sim.sensors, rng)
        self._ticks = 0
        self._sensors = (
            (topics.HARDWARE_IMU, imu_template(TORSO)),
            *zip(
                topics.HARDWARE_SOLES, map(wrench_template, CONTACT_LINKS), strict=True
            ),
            (
                topics.HARDWARE_JOINTS,
                joint_state_template(JOINT_NAMES, with_effort=True),
            ),
        )
        self._publishers = [self.publisher(topic) for topic, _ in self._sensors]
        self._position = np.zeros(len(JOINT_NAMES))
        self._trajectory: FollowedTrajectory | None = None
        height = robot.settings.stretched_leg_length_m
        self._hardware.place(np.array([0.0, 0.0, height]), self._position)
        for _ in range(_SETTLING_TICKS):
            self._drive()
        self._standing = self._hardware.save()
        commands = topics.HARDWARE_COMMANDS
        self.create_subscription(
            message_type(commands),
            commands.name,
            self._on_trajectory,
            qos_profile(commands),
        )
        self.create_service(Trigger, f"{NAME}/reset", self._on_reset)
        self._lockstep = settings.pace == "lockstep"
        if self._lockstep:
            self._timer = self.create_timer(_IDLE_S, self._publish)
        else:
            self._period_ns = round(CONTROL_PERIOD_NS / settings.realtime_factor)
            self._due_ns = time.monotonic_ns()
            self.create_timer(self._period_ns * 1e-9, self._keep_time)

    def close(self) -> None:
        """End the plant."""
        self._hardware.close()

    def _keep_time(self) -> None:
        """Do the control ticks that are due; a longer stall is lost to the clock."""
        now_ns = time.monotonic_ns()
        self._due_ns = max(self._due_ns, now_ns - _MADE_UP_TICKS * self._period_ns)
        while self._due_ns <= now_ns:
            self._due_ns += self._period_ns
            self._tick()

    def _tick(self) -> None:
        self._drive()
        self._publish()

    def _drive(self) -> None:
        """Drive the joints to where they are to be, and read the sensors."""
        self._ticks += 1
        q, to = self._position, self._position
        if self._trajectory is not None:
            to = self._trajectory.at(self._ticks * CONTROL_PERIOD_NS)
        self._position = to
        self._reading = self._hardware.exchange(q, (to - q) / CONTROL_PERIOD_S)

    def _publish(self) -> None:
        """Publish the newest reading."""
        reading = self._reading
        left, right = reading.soles
        imu = np.concatenate([reading.orientation, reading.acceleration])
        for publisher, (_, template), values in zip(
            self._publishers,
            self._sensors,
            (imu, left, right, reading.joints),
            strict=True,
        ):
            publisher.publish(template.fill(values, self._ticks))

    def _on_trajectory(self, message: JointTrajectory) -> None:
        if self._lockstep:
            # Time has stood still for the robot: it begins now.
            message.header.stamp.sec = message.header.stamp.nanosec = 0
        now_ns = self._ticks * CONTROL_PERIOD_NS
        try:
            self._trajectory = FollowedTrajectory(message, now_ns, self._position)
        except RefusedMessageError as error:
            self.refuse(topics.HARDWARE_COMMANDS, "refused", error)
            return
        if self._lockstep:
            self._timer.reset()
            for _ in range(TICKS_PER_LEARNING_TICK):
                self._tick()

    def _on_reset(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        self._hardware.load(self._standing)
        self._position, self._trajectory = np.zeros(len(JOINT_NAMES)), None
        self._tick()
        response.success = True
        return response


def main() -> int:
    """Run the node as a process."""
    return run_node(HardwareNode)


if __name__ == "__main__":
    sys.exit(main())
