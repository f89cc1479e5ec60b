"""Foxglove's server: ROS topics as channels, their messages as the bytes they came in.

The server is that of foxglove-sdk, which the extra `foxglove` brings; without it, this
module cannot be imported. Nothing comes in by the server: it offers neither services
nor parameters, and takes no messages.
"""

from __future__ import annotations

from collections.abc import Iterable
from queue import Empty, SimpleQueue

import foxglove
from foxglove.websocket import ChannelView, Client, ServerListener

from biped_bag.storage.contents import BagMessage, BagTopic
from biped_bag.storage.definitions import message_definition
from biped_common.errors import BipedError

HOST = "127.0.0.1"


class PortError(BipedError):
    """There can be no server on this port; the text says why."""


class FoxgloveServer:
    """A server on this machine, for any number of clients."""

    def __init__(self, name: str, port: int, topics: Iterable[BagTopic]) -> None:
        """Listen for clients.

        Args:
            name: that clients show.
            port: to listen on; 0 takes a free one.
            topics: offered to every client at once, before there are messages.

        Raises:
            PortError: the port is taken.
        """
        self._context = foxglove.Context()
        self._channels: dict[str, foxglove.Channel] = {}
        self._latched: dict[str, BagMessage | None] = {}
        self._subscribed: SimpleQueue[str] = SimpleQueue()
        for topic in topics:
            self.add_topic(topic)
        try:
            self._server = foxglove.start_server(
                name=name,
                host=HOST,
                port=port,
                server_listener=_Subscriptions(self._subscribed),
                context=self._context,
            )
        except (RuntimeError, OSError) as error:
            raise PortError(f"port {port} of {HOST}: {error}") from None

    @property
    def url(self) -> str:
        """Where clients connect to."""
        return f"ws://{HOST}:{self._server.port}"

    def add_topic(self, topic: BagTopic) -> None:
        """Offer a topic from now on, if it is not yet, with its type's definition.

        Raises:
            BagError: no installed package defines its type.
        """
        if topic.name in self._channels:
            return
        definition = topic.definition or message_definition(topic.type_name)
        self._channels[topic.name] = foxglove.Channel(
            topic.name,
            schema=foxglove.Schema(
                name=topic.type_name, encoding="ros2msg", data=definition.encode()
            ),
            message_encoding=topic.encoding,
            context=self._context,
        )
        if topic.latched:
            self._latched[topic.name] = None

    def send(self, message: BagMessage) -> None:
        """Send a message of a known topic to who has subscribed to it."""
        if message.topic in self._latched:
            self._latched[message.topic] = message
        self._channels[message.topic].log(message.data, log_time=message.log_ns)

    def repeat_latched(self) -> None:
        """Send the last message of latched topics that were subscribed to since.

        To all of the topic's subscribers, since the server tells them not apart.
        """
        while True:
            try:
                message = self._latched.get(self._subscribed.get_nowait())
            except Empty:
                return
            if message is not None:
                self.send(message)

    def close(self) -> None:
        """Let go of the clients."""
        self._server.stop()


class _Subscriptions(ServerListener):
    """Passes on what clients subscribe to, from the server's threads."""

    def __init__(self, topics: SimpleQueue[str]) -> None:
        self._topics = topics

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Note the topic."""
        self._topics.put(channel.topic)
