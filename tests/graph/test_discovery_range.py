"""LOCALHOST keeps other hosts out, SUBNET lets them in: two network namespaces."""

import os
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from biped_ros.environment import node_environment

HOSTS = ("first", "second")
TIMEOUT_S = 60.0
# Known in the two namespaces only.
ADDRESS = "240.231.7.{}/24"
PROGRAM = """
import sys, time
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
rclpy.init()
node = rclpy.create_node("host")
heard = []
if sys.argv[1] == "say":
    publisher = node.create_publisher(String, "word", latched)
    publisher.publish(String(data="sound"))
else:
    node.create_subscription(String, "word", heard.append, latched)
print("ready", flush=True)
end = time.monotonic() + float(sys.argv[2])
while time.monotonic() < end and not heard:
    rclpy.spin_once(node, timeout_sec=0.1)
print(len(heard), flush=True)
"""


def ip(*words):
    """Run `ip`; skip the test where that is not allowed or not there."""
    try:
        done = subprocess.run(["ip", *words], capture_output=True, text=True)
    except FileNotFoundError:
        pytest.skip("there is no `ip` (Debian: iproute2)")
    if done.returncode != 0:
        pytest.skip(f"ip {' '.join(words)}: {done.stderr.strip()}")


def connected(host):
    """Return whether a host's end of the cable works."""
    words = ["ip", "-n", host, "link", "show", "cable"]
    return "state UP" in subprocess.run(words, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def hosts():
    """Names of two network namespaces with a cable between them."""
    names = [f"biped-{os.getpid()}-{host}" for host in HOSTS]
    with ExitStack() as cleanup:
        for name in names:
            ip("netns", "add", name)
            cleanup.callback(subprocess.run, ["ip", "netns", "del", name])
        first, second = names
        ip("-n", first, "link", "add", "cable", "type", "veth", "peer", "cable",
           "netns", second)  # fmt: skip
        for number, name in enumerate(names, start=1):
            ip("-n", name, "addr", "add", ADDRESS.format(number), "dev", "cable")
            ip("-n", name, "link", "set", "lo", "up")
            ip("-n", name, "link", "set", "cable", "up")
        # The middleware looks at the interfaces once, when a node is made.
        end = time.monotonic() + TIMEOUT_S
        while not all(map(connected, names)):
            assert time.monotonic() < end
            time.sleep(0.05)
        yield names


@contextmanager
def program(host, discovery_range, domain, verb, for_s):
    """Run a ROS node on a host."""
    process = subprocess.Popen(
        ["ip", "netns", "exec", host, sys.executable, "-c", PROGRAM, verb, str(for_s)],
        env=node_environment(domain, discovery_range),
        stdout=subprocess.PIPE,
        text=True,
    )
    with process:
        try:
            assert process.stdout.readline() == "ready\n"
            yield process
        finally:
            process.kill()


def heard(hosts, discovery_range, domain, for_s):
    """Return how many messages of the first host a curious second one heard."""
    first, second = hosts
    with (
        program(first, discovery_range, domain, "say", TIMEOUT_S),
        program(second, "SUBNET", domain, "hear", for_s) as listener,
    ):
        return int(listener.stdout.readline())


def test_with_subnet_another_host_hears(hosts, domain):
    assert heard(hosts, "SUBNET", domain, TIMEOUT_S) == 1


def test_with_localhost_another_host_hears_nothing(hosts, domain):
    assert heard(hosts, "LOCALHOST", domain, 4.0) == 0


def test_with_localhost_the_sockets_for_messages_are_bound_to_loopback(hosts, domain):
    first_unicast_port = 7400 + 250 * domain + 10
    with program(hosts[0], "LOCALHOST", domain, "say", TIMEOUT_S) as process:
        ports = {}
        table = Path(f"/proc/{process.pid}/net/udp").read_text()
        for line in table.splitlines()[1:]:
            address, port = line.split()[1].split(":")
            ports[int(port, 16)] = bytes.fromhex(address)[::-1]
    listening = {p: a for p, a in ports.items() if 0 <= p - first_unicast_port < 240}
    assert set(listening.values()) == {bytes([127, 0, 0, 1])}
