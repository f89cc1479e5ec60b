"""The graph on a WebSocket, as Foxglove's app wants it."""
