"""`ros2 bag play` and `record` on a real graph, with the options of rosbag2."""

import os
import pty
import signal
import subprocess
import sys
import time

import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import Trigger
from tests.graph.domains import MODULE, own_domain
from tests.graph.players import SAMPLE, TIMEOUT_S, Listener, wait_for

from biped_bag.storage.reader import BagReader
from biped_ros.cdr import string_text
from msgs_json import topics

DOMAIN = own_domain(MODULE)
COMMAND = (sys.executable, "-m", "ros2_verbs.main", "bag")
ZMP, REFERENCE = topics.ZMP, topics.ZMP_REFERENCE
OFFSET_S, LENGTH_NS = 8.0, 500_000_000


@pytest.fixture(scope="module", autouse=True)
def on_the_domain():
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
        yield


def seconds(data):
    """Return the time of a message on /clock [ns]."""
    clock = deserialize_message(data, Clock).clock
    return 1_000_000_000 * clock.sec + clock.nanosec


def listener():
    """Return one that hears what the tests play."""
    kinds = (ZMP, REFERENCE, topics.CLOCK)
    return Listener(DOMAIN, [(t.name, t.type_name, t.latched) for t in kinds])


# -- play ------------------------------------------------------------------------------

BAG = BagReader(SAMPLE)
START_NS = BAG.start_ns + round(OFFSET_S * 1e9)


@pytest.fixture(scope="module")
def part():
    """Play half a second of the ZMP, chosen by patterns, until a moment, at rate 2."""
    options = (
        *("-e", "/biped/zmp.*", "-x", ".*_reference", "-r", "2", "--clock", "100"),
        *("--start-offset", str(OFFSET_S), "-d", "0.1"),
        *("--playback-until-nsec", str(START_NS + LENGTH_NS)),
    )
    with listener() as heard:
        subprocess.run(
            [*COMMAND, "play", str(SAMPLE), *options],
            stdin=subprocess.DEVNULL,
            check=True,
            timeout=TIMEOUT_S,
        )
        heard.settle()
    return heard.heard


def test_topics_are_chosen_and_excluded_by_patterns(part):
    assert set(part) == {ZMP.name, topics.CLOCK.name}


def test_playing_ends_at_the_moment_that_was_given(part):
    played = list(BAG.messages([ZMP.name], START_NS, START_NS + LENGTH_NS + 1))
    assert len(part[ZMP.name]) == len(played)


def test_the_clock_comes_so_often_a_second_at_the_rate_of_playing(part):
    times_ns = [seconds(data) for data in part[topics.CLOCK.name]]
    period_ns = 20_000_000  # of the recording, 10 ms at twice its speed
    expected = range(START_NS, START_NS + LENGTH_NS, period_ns)
    assert times_ns == list(expected)


def test_keys_pause_step_and_go_on():
    with listener() as heard:
        child, terminal = pty.fork()
        if child == 0:
            options = ("--topics", ZMP.name, "-p", "-l", "--start-offset", "8")
            os.execv(COMMAND[0], [*COMMAND, "play", str(SAMPLE), *options])
        try:
            said = b""
            while b"playing" not in said:
                said += os.read(terminal, 1000)
            os.write(terminal, b"\x1b[C")
            wait_for(lambda: len(heard.order) > 0)
            after_a_step = heard.settle()
            os.write(terminal, b"\x1b[A ")
            wait_for(lambda: len(heard.order) > 10)
            while b"Resuming play." not in said:
                said += os.read(terminal, 1000)
        finally:
            os.kill(child, signal.SIGINT)
            _, status = os.waitpid(child, 0)
            os.close(terminal)
    assert after_a_step == 1
    assert b"Press SPACE for Pause/Resume" in said
    assert b"Set rate to 1.1" in said
    assert os.waitstatus_to_exitcode(status) == 130


# -- record ----------------------------------------------------------------------------

SIM_TIME_NS = 5_000_000_000


class Talker:
    """Says words and the simulated time; what it said has arrived."""

    def __init__(self):
        self.node = Node("talker", context=self._context(), enable_rosout=False)
        self.words = self.node.create_publisher(String, "/words", 10)
        self.others = self.node.create_publisher(String, "/others", 10)
        self.clock = self.node.create_publisher(Clock, "/clock", 10)

    def _context(self):
        self.context = rclpy.Context()
        rclpy.init(context=self.context, domain_id=DOMAIN)
        return self.context

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)

    def say(self, text):
        self.words.publish(String(data=text))
        assert self.words.wait_for_all_acked(Duration(seconds=TIMEOUT_S))

    def tick(self, time_ns):
        message = Clock()
        message.clock.sec, message.clock.nanosec = divmod(time_ns, 1_000_000_000)
        self.clock.publish(message)
        time.sleep(0.2)  # whoever listens to it is not one that acknowledges

    def ask(self, verb):
        client = self.node.create_client(Trigger, f"/recorder_node/{verb}")
        wait_for(client.service_is_ready)
        future = client.call_async(Trigger.Request())
        rclpy.spin_until_future_complete(
            self.node, future, self.executor(), timeout_sec=TIMEOUT_S
        )
        return future.result().message

    def executor(self):
        return rclpy.executors.SingleThreadedExecutor(context=self.context)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Record words: while paused, before simulated time has begun, and after."""
    folder = tmp_path_factory.mktemp("recorded") / "bag"
    options = (
        *("--start-paused", "--use-sim-time", "--topic-types", "std_msgs/msg/String"),
        *("--exclude-topics", "/others", "-o", str(folder)),
    )
    with Talker() as talker:
        process = subprocess.Popen(
            [*COMMAND, "record", *options],
            stdin=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            wait_for(lambda: talker.words.get_subscription_count() == 1)
            wait_for(lambda: talker.clock.get_subscription_count() == 1)
            talker.say("while paused")
            answers = [talker.ask("resume")]
            talker.say("before simulated time")
            talker.tick(SIM_TIME_NS)
            talker.say("in simulated time")
            answers.append(talker.ask("pause"))
            talker.say("while paused again")
            others = talker.others.get_subscription_count()
            process.send_signal(signal.SIGINT)
            assert process.wait(TIMEOUT_S) == 0
        finally:
            process.kill()
            process.wait(TIMEOUT_S)
    messages = list(BagReader(folder).messages())
    return messages, answers, others


def test_what_comes_while_paused_or_before_simulated_time_is_left_out(recorded):
    messages, _, _ = recorded
    words = [string_text(m.data) for m in messages if m.topic == "/words"]
    assert words == ["in simulated time"]


def test_log_times_are_simulated(recorded):
    messages, _, _ = recorded
    assert {message.log_ns for message in messages} == {SIM_TIME_NS}


def test_the_recorder_says_whether_it_records(recorded):
    _, answers, _ = recorded
    assert answers == ["recording", "paused"]


def test_topics_of_other_types_and_excluded_ones_are_not_listened_to(recorded):
    messages, _, others = recorded
    assert {message.topic for message in messages} == {"/words"}
    assert others == 0
