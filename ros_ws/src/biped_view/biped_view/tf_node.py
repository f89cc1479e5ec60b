"""A node that publishes /tf, so that rviz2 moves the robot as it is.

    ros2 run biped_view tf_node

One message per torso pose, 25 Hz, made of it, the joint states and the robot
description. It stands in for robot_state_publisher: not both on one graph.

What failures do:
    the installed rosidl is not the one that the type is made for: one line, exit
        status 2.
    the robot is described in a way that its links cannot be placed: a warning, no /tf.
"""

from __future__ import annotations

import sys
from typing import Any

from biped_bag.recorder.intake import Intake, listener_beside
from biped_bag.selection import Selection
from biped_common.errors import BipedError
from biped_ros.guarded import GuardedNode
from biped_ros.link_transforms import (
    MADE_OF,
    TF,
    RobotDescriptionError,
    TransformSource,
)
from biped_ros.running import run_node

NAME = "tf_node"
_TURN_S = 0.02


class NoTypeError(BipedError):
    """The type of /tf is neither installed nor can it be made."""


class TfNode(GuardedNode):
    """Publishes where the links are."""

    def __init__(self, **options: Any) -> None:
        """Listen.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            NoTypeError: /tf cannot be published.
        """
        super().__init__(NAME, **options)
        try:
            self._tf = self.publisher(TF)
        except ImportError as error:
            raise NoTypeError(str(error)) from None
        self._source = TransformSource()
        self._listener = listener_beside(self)
        wanted = Selection(names=frozenset(topic.name for topic in MADE_OF))
        self._intake = Intake(self._listener, wanted, lambda _: None, self.warn)
        self._intake.expect(MADE_OF)
        self.create_timer(_TURN_S, self._turn)

    def close(self) -> None:
        """Listen no longer."""
        self._listener.destroy_node()

    def _turn(self) -> None:
        for message in self._intake.take():
            try:
                made = self._source.hear(message.topic, message.data)
            except RobotDescriptionError as error:
                self.warn(f"{TF.name} cannot be made: {error}")
                continue
            if made is not None:
                self._tf.publish(made)


def main() -> int:
    """Run the node as a process."""
    return run_node(TfNode)


if __name__ == "__main__":
    sys.exit(main())
