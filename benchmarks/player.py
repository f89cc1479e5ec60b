"""How punctual and how complete `biped bag play` is, for a subscriber in a process.

The sample bag is played to raw subscriptions with a history of 1,000 messages, at the
recorded rate, at ten times that, and flat out.
"""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterable
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

from benchmarks.report import Figure

_BAG = Path(__file__).parent.parent / "bags/sample"
_DOMAIN = 120
_DURATION_S = 10.0
_LATE_BOUND_MS = 50.0
_RUNS = (("10 times as fast", 10.0), ("flat out", float("inf")))
_SILENCE_S = 1.0


def measure() -> list[Figure]:
    """Return the error of the end time and the messages lost."""
    # Before rclpy is loaded, here and in the subscriber.
    from biped_bringup.bag.player_node import player_environment

    os.environ.update(player_environment(_DOMAIN, "LOCALHOST"))
    played, _ = _played(1.0, _DURATION_S)
    figures = [
        Figure(
            f"player, {_DURATION_S:g} s in real time: error of the end time",
            1000.0 * abs(played.duration_s - _DURATION_S),
            "ms",
            _LATE_BOUND_MS,
        ),
        Figure(
            f"player, {_DURATION_S:g} s in real time: latest message",
            1000.0 * played.worst_lateness_s,
            "ms",
        ),
    ]
    for name, rate in _RUNS:
        played, received = _played(rate, None)
        figures += [
            Figure(
                f"player, {name}: messages per second",
                played.messages / played.duration_s,
                "",
            ),
            Figure(f"player, {name}: of {played.messages} messages lost",
                   played.messages - received, "", 0.0),
        ]  # fmt: skip
    return figures


def _played(rate: float, duration_s: float | None) -> tuple[Any, int]:
    """Play the bag; return what was played and how many messages were received."""
    from biped_bringup.bag.playback import PlayRequest, play
    from biped_bringup.bag.reader import BagReader

    bag = BagReader(_BAG)
    topics = [(topic.name, topic.type_name) for topic in bag.topics.values()]
    spawn = multiprocessing.get_context("spawn")
    ready, over = spawn.Event(), spawn.Event()
    received = spawn.Queue()
    listener = spawn.Process(target=_listen, args=(topics, ready, over, received))
    listener.start()
    try:
        ready.wait(30.0)
        request = PlayRequest(rate=rate, duration_s=duration_s)
        played = play(bag, request, _DOMAIN, lambda: False, lambda _: None)
        over.set()
        return played, received.get(timeout=60.0)
    finally:
        listener.join(10.0)
        listener.kill()


def _listen(
    topics: Iterable[tuple[str, str]], ready: Event, over: Event, received: Any
) -> None:
    """Count messages until playing is over and nothing more comes."""
    import time

    import rclpy
    from rclpy.experimental import EventsExecutor
    from rclpy.task import Future

    from msgs_json.ros.guarded import message_type
    from msgs_json.ros.qos import qos_profile
    from msgs_json.topics import Topic

    rclpy.init()
    node = rclpy.create_node("listener")
    count, last = 0, time.monotonic()

    def take(_: bytes) -> None:
        nonlocal count, last
        count, last = count + 1, time.monotonic()

    for name, type_name in topics:
        topic = Topic(name, type_name)
        node.create_subscription(
            message_type(topic), name, take, qos_profile(topic), raw=True
        )
    executor = EventsExecutor()
    executor.add_node(node)
    ready.set()
    while not over.is_set() or time.monotonic() - last < _SILENCE_S:
        executor.spin_until_future_complete(Future(), timeout_sec=0.2)
    received.put(count)
    rclpy.shutdown()
