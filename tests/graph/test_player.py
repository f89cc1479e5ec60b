"""`biped bag play` on a real graph: what subscribers get, and when."""

import json
import signal
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock
from tests.graph.domains import MODULE, own_domain
from tests.graph.players import SAMPLE, Listener, Player, recorder, wait_for

from biped_bag.storage.reader import BagReader
from biped_bringup.cli.main import main
from msgs_json import topics
from ros2_verbs.main import main as ros2

DOMAIN = own_domain(MODULE)
INTERRUPTED = 130
PERIOD_NS = 10_000_000
BAG = BagReader(SAMPLE)
ALL = [(t.name, t.type_name, t.latched) for t in BAG.topics.values()]
WITHOUT_DIAGNOSTICS = [t for t in ALL if t[0] != topics.DIAGNOSTICS.name]
LATCHED = {topic.name for topic in BAG.topics.values() if topic.latched}
STEPS = len(LATCHED) + 1
_FIRST = next(BAG.messages([topics.OBSERVATION.name]))
# Some way into the walk.
START_S = 2.0 + (_FIRST.log_ns - BAG.start_ns) // 1_000_000_000
DURATION_S = 1.0


def recorded(topic, start_ns=None, end_ns=None):
    """Return the bytes of a topic's messages, in order, as they come from the wire."""
    messages = BAG.messages([topic], start_ns, end_ns)
    return [on_the_wire(message.data) for message in messages]


def on_the_wire(payload):
    """Fill up to whole 32-bit words, as RTPS does behind what the message says."""
    return payload + bytes(-len(payload) % 4)


# -- everything, message for message, and recorded again -------------------------------


@dataclass
class Replay:
    """What was heard of a replay, by topic, and its recording."""

    heard: dict[str, list[bytes]]
    bag: Path


@pytest.fixture(scope="module", params=[("--rate", "10"), ("--flat-out",)], ids=str)
def whole(request, tmp_path_factory):
    """Play the whole bag to a listener and a recorder."""
    folder = tmp_path_factory.mktemp("again") / "bag"
    # The recorder speaks on /diagnostics, too.
    diagnostics = topics.DIAGNOSTICS
    remap = ("--remap", f"{diagnostics.name}:=/recorded/diagnostics")
    with Listener(DOMAIN, WITHOUT_DIAGNOSTICS) as listener, recorder(DOMAIN, folder):
        listener.listen(
            "/recorded/diagnostics", diagnostics.type_name, False, diagnostics.name
        )
        listener.await_node("recorder_node")
        with Player(DOMAIN, *request.param, *remap) as player:
            status, words = player.end()
        assert status == 0, words
        listener.settle()
    return Replay(listener.heard, folder)


@pytest.mark.parametrize("topic", sorted(BAG.topics))
def test_every_message_arrives_as_it_was_recorded(whole, topic):
    assert whole.heard[topic] == recorded(topic)


def verification(capsys, *arguments):
    status = main(["bag", "verify", "--json", *map(str, arguments)])
    return status, json.loads(capsys.readouterr().out)


def test_a_recorded_replay_is_verified_as_the_original(whole, capsys):
    replayed = verification(capsys, whole.bag, "--run-of", SAMPLE)
    assert replayed == verification(capsys, SAMPLE)
    assert replayed[0] == 0


def test_a_recorded_replay_alone_cannot_be_verified(whole, capsys):
    assert main(["bag", "verify", str(whole.bag)]) == 2
    assert "has no record biped.run" in capsys.readouterr().err


# -- paused, step by step, in a loop ---------------------------------------------------


@dataclass
class Session:
    """What happened while somebody used the services."""

    after_steps: int = 0
    first: list[str] = field(default_factory=list)
    late: list[bytes] = field(default_factory=list)
    answers: dict[str, tuple[bool, str]] = field(default_factory=dict)
    while_paused: list[int] = field(default_factory=list)
    passes: int = 0
    status: int = 0
    words: str = ""


@pytest.fixture(scope="module")
def session():
    """Step through a stretch of the walk, play it over and over, and interrupt."""
    done = Session()
    options = ("--paused", "--loop", "--start", f"{START_S}", "--duration", "0.5")
    with Listener(DOMAIN, ALL) as listener, Player(DOMAIN, *options) as player:

        def ask(verb, key):
            answer = listener.ask(verb)
            done.answers[key] = answer.success, answer.message

        for count in range(1, STEPS + 1):
            ask("step", "step while paused")
            wait_for(lambda count=count: len(listener.order) >= count)
        done.after_steps = listener.settle()
        done.first = list(listener.order)
        name = topics.ROBOT_DESCRIPTION.name
        # A node of its own: with two subscriptions, the listener would hear twice.
        with Listener(DOMAIN, [t for t in ALL if t[0] == name]) as late:
            wait_for(lambda: late.heard[name])
            done.late = list(late.heard[name])
        ask("pause", "pause while paused")
        ask("resume", "resume")
        ask("step", "step while playing")
        wait_for(lambda: len(listener.heard["/biped/plan"]) > 2)
        ask("pause", "pause")
        done.while_paused.append(listener.settle())
        ask("step", "step while paused again")
        wait_for(lambda: len(listener.order) > done.while_paused[0])
        done.while_paused.append(listener.settle())
        done.passes = len(listener.heard["/biped/plan"])
        done.status, done.words = player.end(signal.SIGINT)
    return done


@pytest.mark.thorough
def test_a_step_publishes_one_message(session):
    assert session.after_steps == STEPS


def test_latched_topics_come_first(session):
    assert set(session.first[: len(LATCHED)]) == LATCHED


def test_who_comes_late_still_gets_what_is_latched(session):
    assert session.late[0] == recorded(topics.ROBOT_DESCRIPTION.name)[0]


def test_resume_plays_on_and_a_loop_begins_again(session):
    assert session.answers["resume"] == (True, "playing")
    assert session.passes > 2


def test_while_it_is_paused_only_a_step_publishes(session):
    before, after = session.while_paused
    assert after == before + 1


def test_services_say_what_they_could_not_do(session):
    assert session.answers["pause while paused"] == (False, "not playing")
    assert session.answers["step while playing"] == (False, "not paused")


def test_ctrl_c_ends_a_paused_loop_with_130(session):
    assert session.status == INTERRUPTED
    assert "played" in session.words
    assert "Traceback" not in session.words


# -- some topics, under other names, with a clock --------------------------------------

ELSEWHERE = "/recorded/zmp"


@pytest.fixture(scope="module")
def part():
    """Play a second of the ZMP under another name, with the log time as the clock."""
    zmp = topics.ZMP
    options = (
        *("--topics", zmp.name, "--remap", f"{zmp.name}:={ELSEWHERE}", "--clock"),
        *("--start", str(START_S), "--duration", str(DURATION_S), "--rate", "4"),
    )
    there = [*ALL, (ELSEWHERE, zmp.type_name, False)]
    with Listener(DOMAIN, there) as listener, Player(DOMAIN, *options) as player:
        status, words = player.end()
        assert status == 0, words
        listener.settle()
    return listener


def test_only_what_is_asked_for_is_played(part):
    assert set(part.heard) == {ELSEWHERE, topics.CLOCK.name}


def test_a_remapped_topic_has_its_messages(part):
    start_ns = BAG.start_ns + round(START_S * 1e9)
    end_ns = start_ns + round(DURATION_S * 1e9) + 1
    assert part.heard[ELSEWHERE] == recorded(topics.ZMP.name, start_ns, end_ns)


def test_the_clock_is_the_log_time_a_hundred_times_a_second(part):
    clocks = [deserialize_message(b, Clock).clock for b in part.heard["/clock"]]
    times_ns = [1_000_000_000 * clock.sec + clock.nanosec for clock in clocks]
    start_ns = BAG.start_ns + round(START_S * 1e9)
    ticks = round(DURATION_S * 1e9 / PERIOD_NS)
    assert times_ns == [start_ns + PERIOD_NS * tick for tick in range(ticks)]


# -- with the verbs of ros2 ------------------------------------------------------------


@pytest.fixture(scope="module")
def looped():
    """Play the whole bag over and over, quickly."""
    with Player(DOMAIN, "--rate", "10", "--loop") as player:
        yield player


@pytest.mark.parametrize("topic", sorted(BAG.topics))
def test_topic_echo_shows_every_topic(looped, topic, capfd, monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    verb = ["topic", "echo", "--once", "--spin-time", "0.1", "--timeout", "30"]
    assert ros2([*verb, topic]) == 0
    assert capfd.readouterr().out.endswith("---\n")
