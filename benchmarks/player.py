"""How punctual and how complete `biped bag play` is, for a subscriber in a process.

A walk with all its topics, those of 500 Hz at 500 Hz, is played to raw subscriptions
with a history of 1,000 messages: at the recorded rate, ten times as fast, and flat out.
"""

from __future__ import annotations

import multiprocessing
import os
import tempfile
import time
from collections.abc import Iterable
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Any

from benchmarks.report import Figure

_SAMPLE = Path(__file__).parent.parent / "bags/sample"
_DOMAIN = 120
_DURATION_S = 10.0
_LATE_BOUND_MS = 50.0
_SILENCE_S = 1.0
_THINNED = (
    "/clock",
    "/joint_states",
    "/biped/joint_references",
    "/biped/phase",
    "/biped/zmp",
    "/biped/zmp_reference",
)
_COPIES, _CONTROL_TICK_NS = 4, 2_000_000


def measure() -> list[Figure]:
    """Return how late and how fast messages were played, and how many were lost."""
    # Before rclpy is loaded, here and in the subscriber.
    from biped_ros.environment import node_environment

    os.environ.update(node_environment(_DOMAIN, "LOCALHOST"))
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "walk"
        write_walk(bag)
        played, lost, _ = _played(bag, 1.0, _DURATION_S)
        figures = [
            Figure(
                f"player, {_DURATION_S:g} s in real time: error of the end time",
                1000.0 * abs(played.duration_s - _DURATION_S),
                "ms",
                _LATE_BOUND_MS,
            ),
            _latest(f"player, {_DURATION_S:g} s in real time", played),
            Figure(f"player, {_DURATION_S:g} s in real time: lost", lost, "", 0.0),
        ]
        played, lost, cpu_s = _played(bag, 10.0, None)
        figures += _speed("player, 10 times as fast", played, lost, cpu_s)
        figures.append(_latest("player, 10 times as fast", played))
        played, lost, cpu_s = _played(bag, float("inf"), None)
        figures += _speed("player, flat out", played, lost, cpu_s)
    return figures


def _latest(name: str, played: Any) -> Figure:
    return Figure(f"{name}: latest message", 1000.0 * played.worst_lateness_s, "ms")


def _speed(name: str, played: Any, lost: int, cpu_s: float) -> list[Figure]:
    return [
        Figure(f"{name}: per second", played.messages / played.duration_s, "messages"),
        Figure(f"{name}: CPU time", 1e6 * cpu_s / played.messages, "us a message"),
        Figure(f"{name}: of {played.messages} lost", lost, "", 0.0),
    ]


def write_walk(folder: Path) -> None:
    """Write the sample's walk with its thinned topics at 500 Hz.

    Each message of these is written four times, 2 ms apart.
    """
    from biped_bag.storage.contents import BagMessage
    from biped_bag.storage.reader import BagReader
    from biped_bag.storage.writer import BagWriter

    sample = BagReader(_SAMPLE)
    writer = BagWriter(folder)
    for topic in sample.topics.values():
        writer.add_topic(topic)
    begin_ns = next(iter(sample.messages(["/clock"]))).log_ns
    messages = []
    for message in sample.messages():
        at_ns = max(begin_ns, message.log_ns)
        if at_ns > message.log_ns and not sample.topics[message.topic].latched:
            continue
        for copy in range(_COPIES if message.topic in _THINNED else 1):
            copy_ns = at_ns + copy * _CONTROL_TICK_NS
            messages.append(BagMessage(message.topic, message.data, copy_ns, copy_ns))
    for ordered in sorted(messages, key=lambda message: message.log_ns):
        writer.write(ordered)
    writer.close()


def _played(
    folder: Path, rate: float, duration_s: float | None
) -> tuple[Any, int, float]:
    """Play the bag; return what was played, how many were lost, and the CPU time [s].

    The CPU time is that of this process while it plays, with its middleware's threads.
    """
    from biped_bag.player.play import PlayRequest, play
    from biped_bag.storage.reader import BagReader

    bag = BagReader(folder)
    topics = [(topic.name, topic.type_name) for topic in bag.topics.values()]
    spawn = multiprocessing.get_context("spawn")
    ready, over = spawn.Event(), spawn.Event()
    received = spawn.Queue()
    listener = spawn.Process(target=_listen, args=(topics, ready, over, received))
    listener.start()
    try:
        ready.wait(30.0)
        request = PlayRequest(rate=rate, duration_s=duration_s)
        begun_s = time.process_time()
        played = play(bag, request, _DOMAIN, lambda: False, lambda _: None)
        cpu_s = time.process_time() - begun_s
        over.set()
        lost = played.messages - received.get(timeout=60.0)
        return played, lost, cpu_s
    finally:
        listener.join(10.0)
        listener.kill()


def _listen(
    topics: Iterable[tuple[str, str]], ready: Event, over: Event, received: Any
) -> None:
    """Count messages until playing is over and nothing more comes."""
    import rclpy
    from rclpy.experimental import EventsExecutor
    from rclpy.task import Future

    from biped_ros.messages import message_type
    from biped_ros.qos import qos_profile
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
