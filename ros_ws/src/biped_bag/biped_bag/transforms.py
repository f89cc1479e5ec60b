"""/tf among messages that come from the graph, behind those that it is made of.

Its type has no wheel, so none of our nodes publishes it, and viewers of the others show
a robot that stands still. Its topic looks as that of any other publisher would.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from biped_bag.qos import as_rosbag2
from biped_bag.storage.contents import BagMessage, BagTopic
from biped_ros.link_transforms import TF, RobotDescriptionError, TransformSource
from biped_ros.qos import qos_profile
from biped_ros.tf_type import TF_TYPE_HASH
from msgs_json.topics import TORSO_POSE


class MadeTransforms:
    """Makes messages of /tf of the messages that come."""

    def __init__(
        self, announce: Callable[[BagTopic], None], warn: Callable[[str], None]
    ) -> None:
        """Start before the first message.

        Args:
            announce: told of the topic once, before its first message is returned.
            warn: told why there is no /tf.
        """
        self._announce = announce
        self._warn = warn
        self._source = TransformSource()
        self._written = 0
        self._sent_ns = 0

    def put_in(self, messages: Sequence[BagMessage]) -> list[BagMessage]:
        """Return the messages and, among them, those of /tf that they complete.

        Args:
            messages: in the order in which they came.
        """
        together = []
        for message in messages:
            together.append(message)
            if message.topic == TORSO_POSE.name:
                self._sent_ns = message.publish_ns
            try:
                made = self._source.hear(message.topic, message.data)
            except RobotDescriptionError as error:
                self._warn(f"{TF.name} cannot be made: {error}")
                continue
            if made is None:
                continue
            if not self._written:
                offered = [as_rosbag2(qos_profile(TF))]
                self._announce(BagTopic(TF.name, TF.type_name, offered, TF_TYPE_HASH))
            self._written += 1
            together.append(
                BagMessage(TF.name, made, message.log_ns, self._sent_ns, self._written)
            )
        return together
