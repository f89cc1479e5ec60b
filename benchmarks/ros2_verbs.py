"""What `ros2` costs: wall time of short verbs and of TAB, CPU of `topic hz` at 500 Hz.

Wall time includes the start of the interpreter, rclpy and discovery. The publisher
announces itself as the supervisor's nodes do.
"""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from statistics import median

from benchmarks.report import Figure
from biped_ros.environment import node_environment, private_domain

_ROS2 = (sys.executable, "-m", "ros2_verbs.main")
_TOPIC = "/joint_states"
_VERBS = (
    ("topic", "list"),
    ("topic", "info", "-v", _TOPIC),
    ("topic", "type", _TOPIC),
    ("topic", "find", "sensor_msgs/msg/JointState"),
    ("topic", "echo", "--once", _TOPIC),
    ("node", "list"),
    ("node", "info", "/publisher"),
    ("service", "list"),
    ("service", "type", "/publisher/get_type_description"),
    ("doctor", "--report"),
    ("interface", "show", "sensor_msgs/msg/JointState"),
)
_LINES = ("ros2 to", "ros2 topic e")
_TAB_BOUND = 4.0  # times a start of Python
_REPEATS = 5
_VERB_BOUND_S = 1.5
_HZ_S = 10.0
_RATE_HZ = 500.0
_PUBLISHER = f"""
import time, rclpy
from sensor_msgs.msg import JointState
from rclpy.serialization import serialize_message
rclpy.init()
node = rclpy.create_node("publisher")
publisher = node.create_publisher(JointState, "{_TOPIC}", 1000)
twelve = [0.1] * 12
names = [f"joint_{{i}}" for i in range(12)]
message = serialize_message(
    JointState(name=names, position=twelve, velocity=twelve, effort=twelve))
begin, ticks = time.monotonic(), 0
while True:
    publisher.publish(message)
    ticks += 1
    time.sleep(max(0.0, begin + ticks / {_RATE_HZ} - time.monotonic()))
"""


def measure() -> Iterator[Figure]:
    """Yield the figures."""
    environment = node_environment(private_domain(), "LOCALHOST")
    publisher = subprocess.Popen(
        [sys.executable, "-c", _PUBLISHER], env=environment, stderr=subprocess.DEVNULL
    )
    try:
        time.sleep(2.0)
        for words in _VERBS:
            name = f"ros2 {' '.join(words)}, median of {_REPEATS}"
            time_s = _wall_time_s(_ROS2 + words, environment)
            yield Figure(name, time_s, "s", _VERB_BOUND_S)
        start_s = _wall_time_s((sys.executable, "-c", ""), environment)
        for line in _LINES:
            time_s = _wall_time_s(_ROS2, environment | _completing(line))
            yield Figure(f"{line}<TAB>", time_s / start_s, "starts", _TAB_BOUND)
        rate_hz, cpu_share = _hz(environment)
        yield Figure(f"ros2 topic hz {_TOPIC}, CPU", 100.0 * cpu_share, "%", 50.0)
        yield Figure(
            "ros2 topic hz, deviation from the rate",
            100.0 * abs(rate_hz / _RATE_HZ - 1.0),
            "%",
            1.0,
        )
    finally:
        publisher.kill()
        publisher.wait()


def _completing(line: str) -> dict[str, str]:
    return {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_STDOUT_FILENAME": os.devnull,
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
    }


def _wall_time_s(command: tuple[str, ...], environment: dict[str, str]) -> float:
    times_s = []
    for _ in range(_REPEATS):
        begin = time.monotonic()
        subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=True)
        times_s.append(time.monotonic() - begin)
    return median(times_s)


def _hz(environment: dict[str, str]) -> tuple[float, float]:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    process = subprocess.Popen(
        [*_ROS2, "topic", "hz", _TOPIC],
        env=environment,
        stdout=subprocess.PIPE,
        text=True,
    )
    time.sleep(_HZ_S)
    process.send_signal(signal.SIGINT)
    shown, _ = process.communicate()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    rates = re.findall(r"average rate: (\S+)", shown)
    return float(rates[-1]), cpu_s / _HZ_S
