"""The line of `biped up`: what it tells, and that it does not act on the terminal."""

import io
import re
import signal

import pytest
from msgspec.structs import replace
from rich.console import Console
from tests.payloads import STATUS

from biped_bringup.cli.status_screen import StatusScreen
from biped_bringup.supervisor.supervisor import READY, RECORDER, Supervisor
from biped_ros.environment import node_environment
from msgs_json import topics

CLEAR = "\x1b[2J"
LINES = (
    f"sim_node {READY}7)",
    "[INFO] [1.0] [recorder_node]: recording",
    "[WARN] [1.0] [sim_node]: real time is not kept",
    "[ERROR] [1.0] [sim_node]: the physics is gone",
)


@pytest.fixture
def supervisor(domain, tmp_path):
    """A supervisor whose nodes have been heard."""
    supervisor = Supervisor(
        {RECORDER: {}, topics.SIM_NODE: {}},
        node_environment(domain, "LOCALHOST"),
        tmp_path,
        lambda *_: None,
    )
    supervisor.graph.remarks |= {RECORDER: "running", topics.SIM_NODE: "running"}
    yield supervisor
    supervisor.stop()


def shown(supervisor, status=None, encoding="utf-8", lines=()):
    """Return what is on the screen at last."""
    raw = io.BytesIO()
    file = io.TextIOWrapper(raw, encoding=encoding)
    console = Console(file=file, force_terminal=True, width=120, color_system=None)
    with StatusScreen(console, True) as screen:
        supervisor.graph.status = status
        for line in lines:
            screen.line("supervisor", line)
        screen.update(supervisor)
    file.flush()
    frames = raw.getvalue().decode(encoding)
    return re.sub(r"\x1b\[[?0-9;]*[hlAKm]", "", frames).replace("\r", "")


def test_it_says_who_is_waited_for(supervisor):
    del supervisor.graph.remarks[topics.SIM_NODE]
    assert "starting sim_node  0:00:00" in shown(supervisor, STATUS)


def test_one_line_says_how_far_the_learner_is(supervisor):
    text = shown(supervisor, replace(STATUS, subtask=2, target_time_s=3.76))
    line = "learning ━━───────── 3.76 s  episodes 40  survival 70 %  0:00:00"
    assert [each.strip() for each in text.splitlines() if each.strip()] == [line]


def test_a_terminal_that_has_no_such_characters_gets_others(supervisor):
    text = shown(supervisor, replace(STATUS, subtask=2), encoding="ascii")
    assert "learning ##--------- " in text


def test_a_schedule_that_is_complete_fills_the_bar(supervisor):
    status = replace(STATUS, subtask=10, schedule_complete=True)
    assert "learning ━━━━━━━━━━━ " in shown(supervisor, status)


def test_a_walk_that_teaches_nothing_is_told_by_its_speed_and_lateness(supervisor):
    supervisor.graph.figures[topics.SIM_NODE]["host:1"] = {
        "missed 20 ms deadlines": "4",
        "simulated per real time": "0.870",
    }
    text = shown(supervisor, replace(STATUS, frozen=True))
    assert "nothing is learned  0.870 simulated s/s" in text
    assert "4 deadlines missed" in text


def test_on_a_terminal_only_errors_are_written_above_the_line(supervisor):
    text = shown(supervisor, STATUS, lines=LINES)
    assert [line for line in LINES if line in text] == [LINES[-1]]


def test_elsewhere_every_line_is_written():
    file = io.StringIO()
    screen = StatusScreen(Console(file=file, width=120), True)
    for line in LINES:
        screen.line("supervisor", line)
    assert len(file.getvalue().splitlines()) == len(LINES)


def test_what_goes_wrong_stands_below_the_line(supervisor):
    child = supervisor.children[topics.SIM_NODE]
    child.start()
    child.signal(signal.SIGKILL)
    child.wait(60.0)
    supervisor.done_without[RECORDER] = "disk full"
    text = shown(supervisor, STATUS)
    assert "  recorder_node: disk full" in text
    assert re.search(r"  sim_node: ended with status -9", text)


def test_what_nodes_say_does_not_act_on_the_terminal(supervisor):
    supervisor.done_without[RECORDER] = f"{CLEAR}gone"
    supervisor.graph.figures[topics.SIM_NODE]["host:1"] = {
        "simulated per real time": f"{CLEAR}slow"
    }
    text = shown(supervisor, replace(STATUS, frozen=True))
    assert CLEAR not in text
    assert r"\x1b[2Jgone" in text
    assert r"\x1b[2Jslow" in text


def test_lines_of_nodes_do_not_act_on_the_terminal():
    file = io.StringIO()
    StatusScreen(Console(file=file), False).line("sim_node", f"{CLEAR}gone")
    assert file.getvalue() == "[sim_node] \\x1b[2Jgone\n"
