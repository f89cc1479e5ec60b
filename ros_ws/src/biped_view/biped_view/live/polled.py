"""Subscriptions and service clients that are asked, instead of waking anyone.

An executor wakes Python for every message: at 500 Hz that alone costs more than the
whole page. Here the middleware keeps the last messages, and whoever draws takes them
when it is about to.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy

from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json.topics import Topic


class PolledTopic:
    """A topic whose messages wait until they are taken."""

    def __init__(self, node: Node, topic: Topic, *, last_only: bool = False) -> None:
        """Subscribe.

        Args:
            node: that nobody spins.
            topic: to listen to.
            last_only: keep the last message only, and ask for none again that got lost.
        """
        qos = qos_profile(topic)
        if last_only:
            qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._subscription = node.create_subscription(
            message_type(topic), topic.name, lambda _: None, qos, raw=True
        )

    def take(self) -> list[bytes]:
        """Return the serialized messages since the last time, the oldest first."""
        taken: list[bytes] = []
        subscription = self._subscription
        with subscription.handle:
            while True:
                found = subscription.handle.take_message(subscription.msg_type, True)
                if found is None:
                    return taken
                taken.append(bytes(found[0]))

    def last(self) -> bytes | None:
        """Return the last message since the last time, if there was one."""
        taken = self.take()
        return taken[-1] if taken else None


class PolledService:
    """A service whose answers wait until they are taken."""

    def __init__(self, node: Node, kind: Any, name: str) -> None:
        """Make the client.

        Args:
            node: that nobody spins.
            kind: of the service.
            name: of the service.
        """
        self._client = node.create_client(kind, name)
        self._kind = kind
        self._waiting: dict[int, Callable[[Any], None]] = {}

    def ask(self, then: Callable[[Any], None], **fields: Any) -> bool:
        """Send a request; `take` tells `then` the response.

        Returns:
            False where nobody offers the service; nothing is sent then.
        """
        if not self._client.service_is_ready():
            return False
        with self._client.handle:
            number = self._client.handle.send_request(self._kind.Request(**fields))
        self._waiting[number] = then
        return True

    def take(self) -> None:
        """Hand on the answers that have come."""
        while self._waiting:
            with self._client.handle:
                header, response = self._client.handle.take_response(
                    self._kind.Response
                )
            if header is None:
                return
            then = self._waiting.pop(header.request_id.sequence_number, None)
            if then is not None:
                then(response)

    def forget(self) -> None:
        """Wait for no answer any more: who was asked has gone."""
        self._waiting.clear()
