"""A process that hears what a recorder should hear, by other means: rclpy callbacks.

    python witness.py FILE

writes, when it is terminated, a pickle of (messages by topic, errors in diagnostics).
"""

import pickle
import signal
import sys
from collections import defaultdict
from pathlib import Path

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.experimental import EventsExecutor
from rclpy.task import Future

from biped_ros.messages import message_type
from biped_ros.qos import qos_profile
from msgs_json import topics

DEPTH = 20_000


def main(file):
    """Listen until SIGTERM."""
    stops = []
    signal.signal(signal.SIGTERM, lambda *_: stops.append(True))
    rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)
    node = rclpy.create_node("witness")
    heard, errors = defaultdict(list), []

    def diagnose(message):
        for status in message.status:
            if status.level == DiagnosticStatus.ERROR:
                errors.append(f"{status.name}: {status.message}")

    for topic in vars(topics).values():
        if isinstance(topic, topics.Topic) and topic is not topics.DIAGNOSTICS:
            qos = qos_profile(topic)
            qos.depth = DEPTH
            node.create_subscription(
                message_type(topic), topic.name, heard[topic.name].append, qos, raw=True
            )
    node.create_subscription(DiagnosticArray, topics.DIAGNOSTICS.name, diagnose, 100)
    executor = EventsExecutor()
    executor.add_node(node)
    never = Future()
    while not stops:
        executor.spin_until_future_complete(never, timeout_sec=0.2)
    file.write_bytes(pickle.dumps((dict(heard), errors)))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
