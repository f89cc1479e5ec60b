"""`ros2 topic` on a real graph, against the formats of the original."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import Twist, TwistStamped, Vector3
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String
from tests.ros2_verbs.golden_texts import golden

from biped_common.terminal_text import printable
from ros2_verbs.main import main

TIMEOUT_S = 60.0
PERIOD_S = 0.02
HOSTILE = "\x1b]0;title\x07\x9b2J\u202e歩行"
ONCE = ("--once", "--timeout", "30")


class Talker:
    """A node that publishes as the tutorials' do, in a thread of its own."""

    def __init__(self, domain: int) -> None:
        self._context = rclpy.Context()
        rclpy.init(context=self._context, domain_id=domain)
        self.node = Node("talker", context=self._context)
        self.heard: list[str] = []
        twist = self.node.create_publisher(Twist, "cmd_vel", 10)
        stamped = self.node.create_publisher(TwistStamped, "stamped", 10)
        text = self.node.create_publisher(String, "chatter", 10)
        latched = self.node.create_publisher(
            String,
            "latched",
            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        )
        unreliable = self.node.create_publisher(
            String,
            "unreliable",
            QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
        )
        self.node.create_publisher(String, "two_types", 10)
        # A participant of its own, since one cannot have two types under a name.
        self._other_context = rclpy.Context()
        rclpy.init(context=self._other_context, domain_id=domain)
        self._other = Node("other", context=self._other_context, enable_rosout=False)
        self._other.create_publisher(Twist, "two_types", 10)
        self.node.create_subscription(
            String, "chit_chatter", lambda message: self.heard.append(message.data), 10
        )
        latched.publish(String(data='{"end": "completed"}'))
        self.hostile = self.node.create_publisher(
            String,
            "hostile",
            QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL),
        )
        self.hostile.publish(String(data=HOSTILE))

        def publish() -> None:
            twist.publish(Twist(linear=Vector3(x=2.0)))
            message = TwistStamped()
            message.header.stamp = self.node.get_clock().now().to_msg()
            stamped.publish(message)
            text.publish(String(data="Hello World"))
            unreliable.publish(String(data="perhaps"))

        self.node.create_timer(PERIOD_S, publish)
        self._thread = threading.Thread(target=self._spin)
        self._thread.start()

    def _spin(self) -> None:
        executor = SingleThreadedExecutor(context=self._context)
        executor.add_node(self.node)
        with contextlib.suppress(ExternalShutdownException):
            executor.spin()

    def close(self) -> None:
        rclpy.shutdown(context=self._context)
        self._thread.join(TIMEOUT_S)
        self.node.destroy_node()
        self._other.destroy_node()
        rclpy.shutdown(context=self._other_context)


@pytest.fixture
def talker(domain: int, monkeypatch: pytest.MonkeyPatch) -> Iterator[Talker]:
    """Return a talker; verbs of this process and its children look at its domain."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    # What the verbs add to the environment goes with the test.
    monkeypatch.setenv(
        "AMENT_PREFIX_PATH", os.environ.get("AMENT_PREFIX_PATH", sys.prefix)
    )
    started = Talker(domain)
    yield started
    started.close()


def ros2(*words: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "ros2_verbs.main", *words],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def test_one_shot_verbs_print_what_the_original_prints(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    def printed(*words: str) -> str:
        assert main(["topic", *words]) == 0
        return capfd.readouterr().out

    assert printed("info", "/cmd_vel") == golden("topic_info")
    verbose = printed("info", "-v", "/chatter")
    verbose = re.sub(r"GID: [0-9a-f.]+\n", "GID: <GID>\n", verbose)
    verbose = re.sub(r"\(Depth\): \w+( \(\d+\))?", "(Depth): <HISTORY>", verbose)
    assert verbose == golden("topic_info_verbose")
    assert printed("type", "/chatter") == "std_msgs/msg/String\n"
    assert printed("find", "geometry_msgs/msg/Twist").splitlines()[0] == "/cmd_vel"
    twist = printed("echo", *ONCE, "/cmd_vel")
    assert twist == golden("topic_echo_twist")
    row = printed("echo", *ONCE, "--csv", "/cmd_vel")
    assert row == "2.0,0.0,0.0,0.0,0.0,0.0\n"
    field = printed("echo", *ONCE, "--field", "linear.x", "/cmd_vel")
    assert field == "2.0\n---\n"
    raw = printed("echo", *ONCE, "--raw", "-f", "/chatter")
    assert raw.startswith("b'\\x00\\x01\\x00\\x00\\x0c\\x00\\x00\\x00Hello World\\x00")
    info = printed("echo", *ONCE, "-i", "/chatter").splitlines()
    assert info[0].startswith("publication_sequence_number: ")
    assert info[-3:] == ["---", "data: Hello World", "---"]


def test_lists_have_the_forms_of_the_original(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    second = talker.node.create_publisher(Twist, "cmd_vel", 10)
    main(["topic", "list", "-v"])
    shown = capfd.readouterr().out.splitlines(keepends=True)
    for line in golden("topic_list_verbose").splitlines(keepends=True):
        if "parameter_events" not in line:  # has as many publishers as there are nodes
            assert line in shown
    main(["topic", "list", "-t"])
    assert "/chatter [std_msgs/msg/String]\n" in capfd.readouterr().out
    main(["topic", "list", "-c"])
    assert capfd.readouterr().out.strip().isdecimal()
    assert second is not None


def test_echo_suits_latched_and_unreliable_publishers(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    main(["topic", "echo", *ONCE, "--json", "/latched"])
    assert capfd.readouterr().out == '{\n  "end": "completed"\n}\n---\n'
    main(["topic", "echo", *ONCE, "/unreliable"])
    assert capfd.readouterr().out == "data: perhaps\n---\n"


@pytest.mark.parametrize(
    "form", [(), ("--csv",), ("--json",), ("--raw",), ("--field", "data"), ("-i",)]
)
def test_no_form_of_echo_lets_a_message_act_on_the_terminal(
    talker: Talker, form: tuple[str, ...], capfd: pytest.CaptureFixture[str]
) -> None:
    assert main(["topic", "echo", *ONCE, *form, "/hostile"]) == 0
    shown = capfd.readouterr().out
    assert "]0;title" in shown
    assert shown == printable(shown, layout=True)


def test_one_message_that_does_not_come_in_time_is_a_failure(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    words = ["--once", "--timeout", "0.2", "--spin-time", "1", "/two_types"]
    assert main(["topic", "echo", *words, "std_msgs/msg/String"]) == 1
    assert capfd.readouterr() == ("", "/two_types: no message came in 0.2 s\n")


def test_echo_falls_back_to_what_connects_to_all_publishers(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    unreliable = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    second = talker.node.create_publisher(String, "chatter", unreliable)
    main(["topic", "echo", *ONCE, "--spin-time", "2", "/chatter"])
    assert capfd.readouterr().out == (
        "Some, but not all, publishers are offering QoSReliabilityPolicy.RELIABLE. "
        "Falling back to QoSReliabilityPolicy.BEST_EFFORT as it will connect to all "
        "publishers\ndata: Hello World\n---\n"
    )
    assert second is not None


@pytest.mark.thorough
def test_what_cannot_be_is_one_line_and_status_1(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    for words, error in (
        (["info", "/nowhere"], "Unknown topic '/nowhere'"),
        (["echo", "/no where"], "'/no where': "),
        (["echo", "/nowhere"], "Could not determine the type for the passed topic"),
        (["echo", "/chatter", "no_msgs/Foo"], "The passed message type is invalid: "),
        (["echo", "/two_types"], "Cannot echo topic '/two_types', as it contains more"),
        (["echo", "--field", ".", "/chatter"], "Invalid field value '.'"),
        (["echo", "--field", "d", "/chatter"], "Invalid field 'd': 'String' object "),
        (["echo", "--filter", "m.", "/chatter"], "Invalid filter 'm.': "),
        (["delay", "/chatter"], "msg does not have header"),
        (["pub", "/no where", "std_msgs/msg/String"], "Invalid topic name: "),
        (["pub", "-n", "no name", "/x", "std_msgs/msg/String"], "Invalid node name: "),
        (["pub", "/x", "std_msgs/msg/Foo"], "The passed message type is invalid: "),
        (["pub", "/x", "std_msgs/msg/String", "{a: ["], "The passed value is no valid"),
        (["pub", "/x", "std_msgs/msg/String", "a: 1"], "Failed to populate field: "),
        (
            ["pub", "-1", "--max-wait-time-secs", "0.1", "/x", "std_msgs/msg/Empty"],
            "Timed out waiting for subscribers: Expected 1 subscribers but only got 0",
        ),
    ):
        verb, *rest = words
        more = []
        if "/nowhere" in words:
            more = ["--spin-time", "1"]
        elif verb == "echo":
            # The second type is another node's, which may be found late.
            more = [
                "--timeout",
                "20",
                "--spin-time",
                "4" if "/two" in words[1] else "1",
            ]
        assert main(["topic", verb, *more, *rest]) == 1
        lines = capfd.readouterr().err.splitlines()
        assert len(lines) == 1 and lines[0].startswith(error)


def test_what_is_published_arrives_and_is_printed(
    talker: Talker, capfd: pytest.CaptureFixture[str]
) -> None:
    string = "std_msgs/msg/String"
    words = ["pub", "-t", "4", "-p", "2", "-r", "50", "/chit_chatter", string]
    assert main(["topic", *words, "data: fizz"]) == 0
    lines = capfd.readouterr().out
    lines = lines[lines.index("publisher: ") :]
    assert lines == golden("topic_pub_every_second")
    end = time.monotonic() + TIMEOUT_S
    while len(talker.heard) < 4 and time.monotonic() < end:
        time.sleep(0.01)
    assert talker.heard == ["fizz"] * 4
    twist = "{linear: {x: 2.0}, angular: {z: 1.8}}"
    words = ["pub", "--once", "-w", "0", "/turn", "geometry_msgs/msg/Twist", twist]
    assert main(["topic", *words]) == 0
    assert capfd.readouterr().out == golden("topic_pub_twist")


def test_rates_are_printed_until_interrupted(talker: Talker) -> None:
    stats = r"\tmin: \S+s max: \S+s std dev: \d+\.\d{5}s window: \d+\n"
    sizes = r"\tMessage size mean: \S+ \w?B min: \S+ \w?B max: \S+ \w?B\n"
    verbs = {
        ("hz", "/chatter"): r"average rate: \d+\.\d{3}\n" + stats,
        ("bw", "/chatter"): r"\S+ \w?B/s from \d+ messages\n" + sizes,
        ("delay", "/stamped"): r"average delay: -?\d+\.\d{3}\n" + stats,
    }
    started = {words: ros2("topic", *words) for words in verbs}
    try:
        for words, process in started.items():
            assert process.stdout is not None
            shown = process.stdout.readline()
            if words[0] == "bw":
                assert shown == "Subscribed to [/chatter]\n"
                shown = process.stdout.readline()
            shown += process.stdout.readline()
            assert re.fullmatch(verbs[words], shown)
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=TIMEOUT_S)
            assert (process.returncode, errors) == (130, "")
    finally:
        for process in started.values():
            process.kill()
            process.communicate()
