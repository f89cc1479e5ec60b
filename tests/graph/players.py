"""A player as a process, and a node of the test's own that hears what it plays."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections import defaultdict
from contextlib import contextmanager
from pathlib import Path

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_srvs.srv import Trigger

from biped_ros.messages import message_type
from msgs_json.topics import Topic

SAMPLE = Path(__file__).parents[2] / "bags/sample"
TIMEOUT_S = 60.0
# What is on its way on this machine arrives within 0.4 s.
_TURN_S = 0.05
_SETTLED_TURNS = 20
_DEPTH = 20_000


class Player:
    """`biped bag play` of the sample as a process; ends with the `with` block."""

    def __init__(self, domain, *options):
        self._command = (
            *(sys.executable, "-m", "biped_bringup.cli.main", "bag", "play"),
            *(str(SAMPLE), "--domain", str(domain), *options),
        )

    def __enter__(self):
        self.process = subprocess.Popen(
            self._command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        return self

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate(timeout=TIMEOUT_S)

    def end(self, number=None):
        """Wait for the end, after a signal if one is given; return status and words."""
        if number is not None:
            self.process.send_signal(number)
        out, err = self.process.communicate(timeout=TIMEOUT_S)
        return self.process.returncode, out + err


class Listener:
    """Hears topics in a thread of its own, as bytes, in the order of arrival."""

    def __init__(self, domain, topics):
        self.heard = defaultdict(list)
        self.order = []
        self._idle_turns = 0
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self._node = Node("listener", context=self._context, enable_rosout=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        for name, type_name, latched in topics:
            self.listen(name, type_name, latched)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._spin)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join(TIMEOUT_S)
        self._executor.shutdown()
        self._node.destroy_node()
        rclpy.shutdown(context=self._context)

    def listen(self, name, type_name, latched, heard_as=None):
        """Subscribe, also while others are being heard."""
        heard_as = heard_as or name
        profile = QoSProfile(depth=_DEPTH)
        if latched:
            profile.durability = DurabilityPolicy.TRANSIENT_LOCAL

        def take(message):
            self.heard[heard_as].append(message)
            self.order.append(heard_as)

        kind = message_type(Topic(name, type_name))
        self._node.create_subscription(kind, name, take, profile, raw=True)

    def ask(self, verb):
        """Call a service of the player; return its answer."""
        client = self._node.create_client(Trigger, f"/player/{verb}")
        wait_for(client.service_is_ready)
        future = client.call_async(Trigger.Request())
        wait_for(future.done)
        return future.result()

    def await_node(self, name):
        """Wait until a node is on the graph."""
        wait_for(lambda: name in self._node.get_node_names())

    def settle(self):
        """Wait until nothing more comes; return how many messages have come.

        Counted are the listener's own turns, so that one that a busy machine holds up
        does not take that for silence.
        """
        self._idle_turns = 0
        wait_for(lambda: self._idle_turns >= _SETTLED_TURNS)
        return len(self.order)

    def _spin(self):
        while not self._ended.is_set():
            before = len(self.order)
            self._executor.spin_once(timeout_sec=_TURN_S)
            self._idle_turns = 0 if len(self.order) > before else self._idle_turns + 1


def wait_for(condition):
    """Fail unless the condition comes true in time."""
    end = time.monotonic() + TIMEOUT_S
    while time.monotonic() < end and not condition():
        time.sleep(0.01)
    assert condition()


@contextmanager
def recorder(domain, folder):
    """Have everything recorded, until a Ctrl-C at the end."""
    process = subprocess.Popen(
        [sys.executable, "-m", "biped_bag.recorder.node", "--ros-args",
         "-p", f"folder:={folder}"],
        env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield
        process.send_signal(signal.SIGINT)
        process.wait(TIMEOUT_S)
    finally:
        process.kill()
        process.wait(TIMEOUT_S)
