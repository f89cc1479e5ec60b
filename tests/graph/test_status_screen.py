"""The live screen of `biped up`: what it tells, and that nothing in it acts on it."""

import io
import re

import pytest
from msgspec.structs import replace
from rich.console import Console
from tests.payloads import RESULT, STATUS

from biped_bringup.cli.status_screen import StatusScreen
from biped_bringup.supervisor.supervisor import RECORDER, Supervisor
from biped_ros.environment import node_environment
from msgs_json import topics

DOMAIN = 7
CLEAR = "\x1b[2J"


@pytest.fixture
def supervisor(domain, tmp_path):
    """A supervisor that has started nothing yet."""
    supervisor = Supervisor(
        {RECORDER: {}, topics.SIM_NODE: {}},
        node_environment(domain, "LOCALHOST"),
        tmp_path,
        lambda *_: None,
    )
    yield supervisor
    supervisor.stop()


def shown(supervisor, *statuses, encoding="utf-8"):
    """Return what is on the screen at last."""
    raw = io.BytesIO()
    file = io.TextIOWrapper(raw, encoding=encoding)
    console = Console(file=file, force_terminal=True, width=120, color_system=None)
    with StatusScreen(console, True, DOMAIN) as screen:
        for status in statuses or (None,):
            supervisor.graph.status = status
            screen.update(supervisor, None)
    file.flush()
    frames = raw.getvalue().decode(encoding)
    return re.sub(r"\x1b\[[?0-9;]*[hlAKm]", "", frames).replace("\r", "")


def test_it_says_which_subtask_of_how_many_is_learned(supervisor):
    assert "subtask 3 of 11 " in shown(supervisor, replace(STATUS, subtask=2))


def test_survival_is_drawn_episode_by_episode(supervisor):
    shares = ((0, 0.0), (1, 0.5), (1, 0.5), (2, 1.0))
    statuses = [replace(STATUS, episodes=e, survival=s) for e, s in shares]
    assert "survival   ▁▅█" in shown(supervisor, *statuses)


def test_a_terminal_that_has_no_such_characters_gets_others(supervisor):
    statuses = [replace(STATUS, episodes=n, survival=float(n)) for n in (0, 1)]
    assert "survival   .@" in shown(supervisor, *statuses, encoding="ascii")


def test_it_says_how_long_how_fast_and_how_late(supervisor):
    supervisor.graph.figures[topics.SIM_NODE]["host:1"] = {
        "missed 20 ms deadlines": "4",
        "simulated per real time": "7.250",
    }
    text = "0:00:00 elapsed, 7.250 simulated s/s, 4 deadlines missed"
    assert text in shown(supervisor)


def test_it_says_how_the_last_walk_ended(supervisor):
    supervisor.graph.result = RESULT
    assert "last walk  completed after 1.88 s, peak ZMP" in shown(supervisor)


def test_it_says_how_to_meet_the_run(supervisor):
    assert f"export ROS_DOMAIN_ID={DOMAIN}" in shown(supervisor)


def test_what_has_ended_is_not_said_to_be_running(supervisor):
    child = supervisor.children[topics.SIM_NODE]
    child.start()  # a node without parameters, which is ended before it is there
    supervisor.stop()
    supervisor.graph.remarks[topics.SIM_NODE] = "running"
    assert "running" not in shown(supervisor)
    assert re.search(r"sim_node .* ended", shown(supervisor))


@pytest.mark.parametrize("node", [RECORDER, topics.SIM_NODE])
def test_what_nodes_say_does_not_act_on_the_terminal(supervisor, node):
    supervisor.graph.remarks[node] = f"{CLEAR}gone"
    supervisor.done_without[node] = f"{CLEAR}gone"
    supervisor.graph.figures[topics.SIM_NODE]["host:1"] = {
        "simulated per real time": f"{CLEAR}gone"
    }
    text = shown(supervisor, replace(STATUS, figures={f"{CLEAR}gone": 1.0}))
    assert CLEAR not in text
    assert r"\x1b[2Jgone" in text


def test_lines_of_nodes_do_not_act_on_the_terminal():
    file = io.StringIO()
    StatusScreen(Console(file=file), False, DOMAIN).line("sim_node", f"{CLEAR}gone")
    assert file.getvalue() == "[sim_node] \\x1b[2Jgone\n"
