"""Check network connectivity between multiple hosts.

Called on several hosts, each greets the others over a topic and over plain multicast,
and prints who was heard: whether ROS does not get through, or the network.
"""

from __future__ import annotations

import argparse
import contextlib
import socket
import struct
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager

from rclpy.task import Future
from std_msgs.msg import String

from biped_common.terminal_text import printable
from ros2_verbs.errors import VerbError
from ros2_verbs.graph.session import caught, graph_node, spin
from ros2_verbs.options import positive_float, positive_int

_GROUP, _PORT = "225.0.0.1", 49150
_MAX_BYTES = 4096
_DEPTH = 10


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    parser.add_argument(
        "-t",
        "--topic",
        default="/canyouhearme",
        help="topic to greet on (default: /canyouhearme)",
    )
    parser.add_argument(
        "-ep",
        "--emit-period",
        metavar="SECONDS",
        type=positive_float,
        default=0.1,
        help="time between two greetings (default: 0.1 s)",
    )
    parser.add_argument(
        "-pp",
        "--print-period",
        metavar="SECONDS",
        type=positive_float,
        default=1.0,
        help="time between two summaries (default: 1.0 s)",
    )
    parser.add_argument(
        "--ttl", type=positive_int, help="how many routers multicast passes"
    )
    parser.add_argument(
        "-1", "--once", action="store_true", help="greet once, print, and exit"
    )


def main(args: argparse.Namespace) -> int:
    """Greet and print until interrupted.

    Raises:
        VerbError: no topic can have such a name, or there is no multicast.
    """
    greeting = f"hello, it's me {socket.gethostname()}"
    summary = Summary(args.topic, args.print_period)
    finished: Future = Future()
    with _multicast(args.ttl) as group, graph_node(args) as node:
        publisher = node.create_publisher(String, args.topic, _DEPTH)

        def hear(message: String) -> None:
            summary.hear(summary.subscribed, message.data)

        def greet() -> None:
            publisher.publish(String(data=greeting))
            summary.published += 1
            try:
                group.sendto(greeting.encode(), (_GROUP, _PORT))
            except OSError as error:
                raise VerbError(f"multicast to {_GROUP}: {error.strerror}") from None
            summary.sent += 1

        def turn() -> None:
            with contextlib.suppress(BlockingIOError):
                while True:
                    heard = group.recv(_MAX_BYTES).decode(errors="replace")
                    summary.hear(summary.received, heard)
            if args.once:
                print(summary.text())
                finished.set_result(None)
            else:
                greet()

        def report() -> None:
            print(summary.text())
            summary.begin()

        node.create_subscription(String, args.topic, caught(finished, hear), _DEPTH)
        greet()
        node.create_timer(args.emit_period, caught(finished, turn))
        if not args.once:
            node.create_timer(args.print_period, caught(finished, report))
        spin(node, finished)
    return 0


class Summary:
    """Greetings sent, and heard from other hosts, since the last summary."""

    def __init__(self, topic: str, period_s: float) -> None:
        """Begin to count.

        Args:
            topic: on which is greeted.
            period_s: between two summaries.
        """
        self._topic, self._period_s = topic, period_s
        self.begin()

    def begin(self) -> None:
        """Count anew."""
        self.published = self.sent = 0
        self.subscribed: Counter[str] = Counter()
        self.received: Counter[str] = Counter()

    def hear(self, counts: Counter[str], greeting: str) -> None:
        """Count a greeting for the host that it ends with, unless that is this one."""
        host = greeting.split(" ")[-1]
        if host != socket.gethostname():
            counts[host] += 1

    def text(self) -> str:
        """Return the table."""
        return "\n".join(
            [
                "MULTIMACHINE COMMUNICATION SUMMARY",
                f"Topic: {self._topic}, Published Msg Count: {self.published}",
                "Subscribed from:",
                *self._rows(self.subscribed),
                f"Multicast Group/Port: {_GROUP}/{_PORT}, Sent Msg Count: {self.sent}",
                "Received from:",
                *self._rows(self.received),
                "-" * 60,
            ]
        )

    def _rows(self, counts: Counter[str]) -> list[str]:
        heading = ("Hostname", f"Msg Count /{self._period_s}s")
        return [
            f"{'':<15} {printable(host):<20} {count:<10}"
            for host, count in [heading, *counts.items()]
        ]


@contextmanager
def _multicast(ttl: int | None) -> Iterator[socket.socket]:
    """Give a socket that sends to the group and hears it, without waiting.

    Raises:
        VerbError: there is no multicast on this machine.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as group:
        try:
            group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            group.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
            if ttl is not None:
                group.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
            group.bind(("", _PORT))
            member = struct.pack("4sl", socket.inet_aton(_GROUP), socket.INADDR_ANY)
            group.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        except OSError as error:
            raise VerbError(f"multicast to {_GROUP}: {error.strerror}") from None
        group.setblocking(False)
        yield group
