"""Plays a robot's motors and sensors: an engine behind the topics of ros2_control.

    python -m sim_node.hardware_node --ros-args -p pace:=realtime

It publishes what the broadcasters of a controller manager publish, and follows what a
forward_position_controller follows; nothing else of it is on the graph. Standing in for
the person who puts a robot back on its feet: the service `/simulated_hardware/reset`.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from std_msgs.msg import Float64MultiArray
from std_srvs.srv import Trigger

from biped_common.seeds import robot_stream
from biped_common.timing import CONTROL_PERIOD_S
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
from sim_node.physics import Array
from sim_node.settings import HardwareNodeSettings
from sim_node.simulated_hardware import SimulatedHardware

NAME = "simulated_hardware"
_SETTLING_TICKS = 150
# In lockstep, after so long without a command, sensors are heard again: time stands
# still for the robot, but it must not seem dead.
_IDLE_S = 0.5


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
        self._position = self._commanded = np.zeros(len(JOINT_NAMES))
        height = robot.settings.stretched_leg_length_m
        self._hardware.place(np.array([0.0, 0.0, height]), self._position)
        for _ in range(_SETTLING_TICKS):
            self._tick()
        self._standing = self._hardware.save()
        commands = topics.HARDWARE_COMMANDS
        self.create_subscription(
            message_type(commands),
            commands.name,
            self._on_commands,
            qos_profile(commands),
        )
        self.create_service(Trigger, f"{NAME}/reset", self._on_reset)
        self._lockstep = settings.pace == "lockstep"
        if self._lockstep:
            self._timer = self.create_timer(_IDLE_S, self._publish)
        else:
            self.create_timer(CONTROL_PERIOD_S / settings.realtime_factor, self._tick)

    def close(self) -> None:
        """End the plant."""
        self._hardware.close()

    def _tick(self) -> None:
        """Drive the joints to where they are to be, and publish what sensors read."""
        q, dq = self._position, (self._commanded - self._position) / CONTROL_PERIOD_S
        self._position = self._commanded
        self._reading = self._hardware.exchange(q, dq)
        self._publish()

    def _publish(self) -> None:
        """Publish the newest reading, under a new stamp."""
        reading = self._reading
        self._ticks += 1
        left, right = reading.soles
        imu = np.concatenate([reading.orientation, reading.acceleration])
        for publisher, (_, template), values in zip(
            self._publishers,
            self._sensors,
            (imu, left, right, reading.joints),
            strict=True,
        ):
            publisher.publish(template.fill(values, self._ticks))

    def _on_commands(self, message: Float64MultiArray) -> None:
        commands: Array = np.array(message.data)
        if commands.shape != self._position.shape or not np.isfinite(commands).all():
            error = RefusedMessageError(f"not {len(JOINT_NAMES)} finite positions")
            self.refuse(topics.HARDWARE_COMMANDS, "refused", error)
            return
        self._commanded = commands
        if self._lockstep:
            self._timer.reset()
            self._tick()

    def _on_reset(
        self, _: Trigger.Request, response: Trigger.Response
    ) -> Trigger.Response:
        self._hardware.load(self._standing)
        self._position = self._commanded = np.zeros(len(JOINT_NAMES))
        self._tick()
        response.success = True
        return response


def main() -> int:
    """Run the node as a process."""
    return run_node(HardwareNode)


if __name__ == "__main__":
    sys.exit(main())
