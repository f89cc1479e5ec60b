"""Control topics have one publisher each: who that is, the middleware says.

What a message says of its sender, anybody can write. The middleware knows better: which
node made the publisher, and on which host. A subscription to a control topic therefore
exists only while the topic is published by its owner and by nobody else. A second
publisher, be it a forgotten node, a bag that is played onto a live domain or `ros2
topic pub`, ends it before anything that it says is acted on; when it has left, a new
subscription is made, which never knew it.
"""

from __future__ import annotations

from collections.abc import Callable

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.topic_endpoint_info import TopicEndpointInfo

from biped_common.terminal_text import printable
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json.topics import Topic

_LOOK_PERIOD_S = 0.05
_PUBLISHED_BY_EVERY_NODE = "/parameter_events"
# The graph learns of a publisher first, and of the node that made it soon after.
_NOT_KNOWN_YET = "_NODE_NAME_UNKNOWN_"
_NO_NODE = "_CREATED_BY_BARE_DDS_APP_"
# Of the identifier, as Fast DDS makes it: vendor of the middleware, then the host.
_VENDOR, _HOST = slice(0, 2), slice(0, 4)


class Publishers:
    """Looks at who publishes on the control topics, through the eyes of one node."""

    def __init__(self, node: Node) -> None:
        """Look through the eyes of a node."""
        self._node = node

    def alone(self, topic: Topic) -> bool:
        """Return whether the owner of a topic publishes on it, and nobody else."""
        return [info.node_name for info in self._of(topic)] == [topic.owner]

    def namesakes(self, topic: Topic) -> bool:
        """Return whether all publishers of a topic may be its owner, by their names."""
        names = {info.node_name for info in self._of(topic)}
        return names <= {topic.owner, _NOT_KNOWN_YET}

    def any_on(self, topic: Topic) -> str | None:
        """Name who publishes on a topic; None where nobody does."""
        publishers = self._of(topic)
        return self._named(publishers) if publishers else None

    def strangers(self, topic: Topic) -> str | None:
        """Name who publishes on a topic, where that is not its owner alone.

        None where the owner does, or nobody, or one who is not known yet.
        """
        publishers = self._of(topic)
        names = [info.node_name for info in publishers]
        if len(names) < 2 and (not names or names[0] in (topic.owner, _NOT_KNOWN_YET)):
            return None
        return (
            f"{topic.name} is published by {self._named(publishers)}, and should be by "
            f"one {topic.owner} only: nothing on it is acted on"
        )

    def _of(self, topic: Topic) -> list[TopicEndpointInfo]:
        found: list[TopicEndpointInfo] = self._node.get_publishers_info_by_topic(
            topic.name
        )
        return found

    def _named(self, publishers: list[TopicEndpointInfo]) -> str:
        own = self._own_identifier()
        return " and ".join(
            sorted(f"{_node(info)} ({_place(info, own)})" for info in publishers)
        )

    def _own_identifier(self) -> bytes:
        """Return the identifier of a publisher of this node's own."""
        name, namespace = self._node.get_name(), self._node.get_namespace()
        for info in self._node.get_publishers_info_by_topic(_PUBLISHED_BY_EVERY_NODE):
            if (info.node_name, info.node_namespace) == (name, namespace):
                return bytes(info.endpoint_gid)
        return b""


def _node(info: TopicEndpointInfo) -> str:
    """Return the name of the node that made a publisher, with its namespace."""
    if info.node_name == _NOT_KNOWN_YET:
        return "a node not known yet"
    if info.node_name == _NO_NODE:
        return "a program that is no ROS node"
    # A program that is no ROS node can call itself anything.
    return printable(f"{info.node_namespace.rstrip('/')}/{info.node_name}".lstrip("/"))


def _place(info: TopicEndpointInfo, own: bytes) -> str:
    identifier = bytes(info.endpoint_gid)
    if identifier[_HOST] == own[_HOST]:
        return "this host"
    if identifier[_VENDOR] == own[_VENDOR]:
        return "another host"
    return "another middleware, host unknown"


class _Reception:
    """A subscription that is believed until it has met a second publisher.

    One that came and went while nobody looked is not on the graph any more, but what it
    said may still wait in the queue. The subscription itself has counted it.
    """

    def __init__(
        self,
        node: Node,
        topic: Topic,
        handle: Callable[[bytes], None],
        publishers: Publishers,
    ) -> None:
        """Subscribe; arguments as of `SolePublisherListener`."""
        self._node = node
        self._topic = topic
        self._handle = handle
        self._publishers = publishers
        self._owner_met = False
        self.believed = True
        self._subscription = node.create_subscription(
            message_type(topic),
            topic.name,
            self._received,
            qos_profile(topic),
            # Such events are handled later, when the subscription may be gone.
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
            raw=True,
        )
        # Asked when a message is there: an event of its own would come too late.
        with self._subscription.handle:
            self._matched = _rclpy.EventHandle(
                self._subscription.handle,
                _rclpy.rcl_subscription_event_type_t.RCL_SUBSCRIPTION_MATCHED,
            )

    def look(self) -> None:
        """Stop to believe where more than one publisher is there, or has ever been met.

        One that has just come is on the graph before it is met, and one that has gone
        has been met before.
        """
        if self.believed and (
            self._node.count_publishers(self._topic.name) > 1
            or self._matched.take_event().total_count > 1
        ):
            self.believed = False

    def end(self) -> None:
        """End the subscription; what still waits in its queue is not heard."""
        self.believed = False
        self._matched.destroy_when_not_in_use()
        self._node.destroy_subscription(self._subscription)

    def _received(self, message: bytes) -> None:
        self.look()
        if self.believed and not self._owner_met:
            self._owner_met = self.believed = self._publishers.alone(self._topic)
        if self.believed:
            self._handle(bytes(message))


class SolePublisherListener:
    """Takes the messages of a control topic while its owner alone publishes on it."""

    def __init__(
        self,
        node: Node,
        topic: Topic,
        handle: Callable[[bytes], None],
        stranger: Callable[[Topic, str | None], None],
        ready: Callable[[], bool] = lambda: True,
        anew: Callable[[], None] = lambda: None,
    ) -> None:
        """Begin to look; messages come as soon as they can be believed.

        Args:
            node: that listens.
            topic: with an owner.
            handle: gets every message, serialized.
            stranger: told, at every look, who publishes beside or instead of the owner,
                None for nobody.
            ready: asked before the subscription is made, now and again after a stranger
                has left.
            anew: told when it is made: what was heard before need not be so.
        """
        self._node = node
        self._topic = topic
        self._handle = handle
        self._stranger = stranger
        self._ready = ready
        self._anew = anew
        self._publishers = Publishers(node)
        self._reception: _Reception | None = None
        node.create_timer(_LOOK_PERIOD_S, self._look)

    def close(self) -> None:
        """Listen no more; a node whose subscription is held stays on the graph."""
        if self._reception is not None:
            self._reception.end()
            self._reception = None

    def _look(self) -> None:
        text = self._publishers.strangers(self._topic)
        self._stranger(self._topic, text)
        reception = self._reception
        if reception is not None:
            reception.look()
            if text is not None or not reception.believed:
                self.close()
        if (
            self._reception is None
            and self._publishers.alone(self._topic)
            and self._ready()
        ):
            self._anew()
            self._reception = _Reception(
                self._node, self._topic, self._handle, self._publishers
            )
