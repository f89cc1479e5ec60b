"""A node that only listens, and shows Foxglove what it hears.

    ros2 run biped_view foxglove_bridge [--ros-args -p port:=8765]

Every topic of the graph, with its ROS definition and its messages undecoded, and /tf,
made of torso pose, joint states and robot description: so the 3D panel moves the robot
as it is. Times are when messages were received, wall clock.

What failures do:
    foxglove-sdk is not installed, or the port is taken: one line, exit status 2.
    a topic whose type is not installed: a warning; the others are shown.
    a client is too slow: it misses messages; the graph notices nothing of it.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import Any

from biped_bag.qos import as_rosbag2
from biped_bag.recorder.intake import Intake, listener_beside
from biped_bag.selection import Selection
from biped_bag.storage.contents import BagTopic
from biped_bag.transforms import MadeTransforms
from biped_common.errors import BipedError
from biped_common.settings import Settings, setting
from biped_ros.guarded import GuardedNode
from biped_ros.link_transforms import TF
from biped_ros.qos import qos_profile
from biped_ros.running import run_node
from msgs_json import topics
from msgs_json.topics import Topic

NAME = "foxglove_bridge"
_TURN_S = 0.02
_LOOK_PERIOD_S = 0.1


@dataclass(frozen=True)
class BridgeSettings(Settings):
    """Where clients connect."""

    port: int = setting(
        8765, "", "of 127.0.0.1 to listen on; 0: a free one", lower=0, upper=65535
    )


class NoFoxgloveError(BipedError):
    """The library that the bridge stands on is not installed."""


class FoxgloveBridge(GuardedNode):
    """Passes on the graph's messages, as bytes."""

    def __init__(self, **options: Any) -> None:
        """Start the server and listen.

        Args:
            options: of `rclpy.node.Node`, such as `parameter_overrides`.

        Raises:
            NoFoxgloveError: foxglove-sdk is not installed.
            PortError: the port is taken.
            SettingsError: a parameter is wrong.
        """
        try:
            from biped_view.foxglove.server import FoxgloveServer
        except ImportError as error:
            raise NoFoxgloveError(
                "the bridge to Foxglove needs foxglove-sdk: "
                f"pip install 'biped[foxglove]' ({error})"
            ) from None
        super().__init__(NAME, **options)
        settings = self.settings_from_parameters(BridgeSettings)
        expected = [t for t in vars(topics).values() if isinstance(t, Topic)]
        offered = [
            BagTopic(t.name, t.type_name, [as_rosbag2(qos_profile(t))])
            for t in (*expected, TF)
        ]
        self.server = FoxgloveServer("biped", settings.port, offered)
        self._listener = listener_beside(self)
        self._intake = Intake(
            self._listener, Selection(), self.server.add_topic, self.warn
        )
        self._intake.leave_out(TF.name)
        self._transforms = MadeTransforms(self.server.add_topic, self.warn)
        self._intake.expect(expected)
        self.create_timer(_TURN_S, self._turn)
        self.create_timer(_LOOK_PERIOD_S, self._intake.look_around)
        self.get_logger().info(f"for Foxglove: {self.server.url}")

    def close(self) -> None:
        """Let go of the clients."""
        self.server.close()
        self._listener.destroy_node()

    def _turn(self) -> None:
        for message in self._transforms.put_in(self._intake.take()):
            self.server.send(message)
        self.server.repeat_latched()


def main() -> int:
    """Run the node as a process."""
    return run_node(FoxgloveBridge)


if __name__ == "__main__":
    sys.exit(main())
