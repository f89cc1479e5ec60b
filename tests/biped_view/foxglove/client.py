"""A client of Foxglove's protocol, on the `websockets` library alone.

https://docs.foxglove.dev/docs/connecting-to-data/frameworks/custom describes it: JSON
texts say what there is, binary messages are an opcode, a subscription, a time and data.
"""

import json
import struct
import threading
from collections import defaultdict

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

_MESSAGE_DATA = struct.Struct("<BIQ")  # opcode 1, subscription, time


class FoxgloveClient:
    """Subscribes to topics as they are advertised, in a thread of its own."""

    def __init__(self, url, wanted):
        self.server = {}
        self.channels = {}
        self.received = defaultdict(list)
        self._wanted = wanted
        self._socket = connect(url, subprotocols=["foxglove.sdk.v1"], max_size=None)
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def close(self):
        self._socket.close()
        self._thread.join(10.0)

    def _listen(self):
        try:
            for message in self._socket:
                if isinstance(message, str):
                    self._hear(json.loads(message))
                else:
                    opcode, topic, _ = _MESSAGE_DATA.unpack_from(message)
                    assert opcode == 1
                    data = message[_MESSAGE_DATA.size :]
                    self.received[self._names[topic]].append(data)
        except ConnectionClosed:
            pass

    def _hear(self, text):
        if text["op"] == "serverInfo":
            self.server = text
        elif text["op"] == "advertise":
            new = {channel["topic"]: channel for channel in text["channels"]}
            self.channels |= new
            self._names = {c["id"]: name for name, c in self.channels.items()}
            subscriptions = [
                {"id": channel["id"], "channelId": channel["id"]}
                for name, channel in new.items()
                if name in self._wanted
            ]
            subscribe = {"op": "subscribe", "subscriptions": subscriptions}
            self._socket.send(json.dumps(subscribe))
