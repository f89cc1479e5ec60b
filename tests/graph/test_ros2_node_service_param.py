"""`ros2 node`, `service`, `param` and `doctor` on a real graph, against golden texts.

The verbs run in this process, but for one: how they end as processes.
"""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import yaml
from tests.graph.domains import MODULE, own_domain
from tests.ros2_verbs.golden_texts import golden

from biped_common.terminal_text import printable
from ros2_verbs.main import main

DOMAIN = own_domain(MODULE + 2)  # where nobody was killed a moment ago
COMMAND = (sys.executable, "-m", "ros2_verbs.main")
TIMEOUT_S = 90.0
# Discovery takes as long as it takes; a list may be looked at again.
LOOKS = 8


@pytest.fixture(scope="module", autouse=True)
def graph():
    """Have the nodes on a domain of their own; the walk is paused."""
    nodes = subprocess.Popen(
        [sys.executable, "-m", "tests.graph.ros2_nodes"],
        env=os.environ | {"ROS_DOMAIN_ID": str(DOMAIN)},
        cwd=Path(__file__).parents[2],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    try:
        assert nodes.stdout is not None and nodes.stdout.readline() == "up\n"
        yield
    finally:
        nodes.terminate()
        nodes.communicate(timeout=TIMEOUT_S)


@pytest.fixture
def ros2(monkeypatch, capfd):
    """Run a verb in this process; return its status, stdout and stderr."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    # What the verbs add to the environment goes with the test.
    monkeypatch.setenv(
        "AMENT_PREFIX_PATH", os.environ.get("AMENT_PREFIX_PATH", sys.prefix)
    )

    def run(*arguments):
        capfd.readouterr()
        try:
            status = main(arguments)
        except SystemExit as end:
            status = end.code
        return status, *capfd.readouterr()

    return run


@pytest.fixture
def settled(ros2):
    """Run a verb until it prints what is expected, some times; return the last."""

    def run(*arguments, until):
        for _ in range(LOOKS):
            outcome = ros2(*arguments)
            if until(outcome):
                break
        return outcome

    return run


def lines(text, *beginnings):
    """Return the lines that begin so."""
    return "".join(
        line for line in text.splitlines(keepends=True) if line.startswith(beginnings)
    )


def test_the_walk_can_be_paused_by_a_call(ros2):
    outcome = ros2(
        "service", "call", "/sim_node/pause", "std_srvs/srv/SetBool", "{data: true}"
    )
    assert outcome == (0, golden("service_call"), "")


def test_nodes_are_listed_and_twins_are_warned_of(settled):
    expected = [
        "/learner_node", "/sim_node", "/teleop_turtle", "/trajectory_node",
        "/turtlesim", "/twin", "/twin",
    ]  # fmt: skip
    status, out, err = settled(
        "node", "list", until=lambda done: done[1].split() == expected
    )
    assert (status, out.split()) == (0, expected)
    assert err.startswith("WARNING: Be aware that there are nodes in the graph that")


def test_hidden_nodes_are_listed_when_asked_for(settled):
    _, out, _ = settled("node", "list", "-a", until=lambda done: "_hidden" in done[1])
    assert "/_hidden\n" in out


def test_nodes_are_counted(settled):
    _, out, _ = settled("node", "list", "-c", until=lambda done: done[1] == "7\n")
    assert out == "7\n"


def test_a_node_tells_what_it_publishes_and_offers(ros2):
    status, out, _ = ros2("node", "info", "/sim_node")
    assert status == 0
    assert out.startswith("/sim_node\n  Subscribers:\n    /biped/episode: std_msgs/")
    assert "  Publishers:\n    /biped/joint_references: sensor_msgs/msg/Joint" in out
    assert "    /sim_node/pause: std_srvs/srv/SetBool\n" in out
    assert out.endswith(
        "  Service Clients:\n\n  Action Servers:\n\n  Action Clients:\n\n"
    )


def test_information_about_twins_comes_with_a_warning(ros2):
    _, _, err = ros2("node", "info", "/twin")
    assert 'There are 2 nodes in the graph with the exact name "/twin".' in err


def test_services_are_listed(settled):
    expected = golden("service_list")
    own = ("/clear", "/reset", "/turtlesim/")
    _, out, _ = settled(
        "service", "list", until=lambda done: lines(done[1], *own) == expected
    )
    assert lines(out, *own) == expected


def test_services_are_listed_with_their_types(settled):
    expected = golden("service_list_types")
    own = ("/clear", "/reset", "/turtlesim/")
    _, out, _ = settled(
        "service", "list", "-t", until=lambda done: lines(done[1], *own) == expected
    )
    assert lines(out, *own) == expected


def test_services_are_found_by_type(settled):
    expected = golden("service_find")
    _, out, _ = settled(
        "service", "find", "std_srvs/srv/Empty", until=lambda done: done[1] == expected
    )
    assert out == expected


def test_the_type_of_a_service_is_told(ros2):
    assert ros2("service", "type", "/sim_node/pause") == (
        0,
        "std_srvs/srv/SetBool\n",
        "",
    )


def test_parameters_of_all_nodes_are_listed(settled):
    expected = golden("param_list")

    def turtles(text):
        sections = text.partition("/trajectory_node:")
        teleop = sections[0].partition("/teleop_turtle:")
        own = sections[2].partition("/turtlesim:")
        return "".join(teleop[1:]) + own[1] + own[2].partition("/twin:")[0]

    _, out, _ = settled(
        "param", "list", until=lambda done: turtles(done[1]) == expected
    )
    assert turtles(out) == expected


def test_parameters_are_listed_with_their_types(ros2):
    outcome = ros2("param", "list", "/turtlesim", "--param-type")
    assert outcome == (0, golden("param_list_types"), "")


def test_parameters_are_listed_by_prefix_and_pattern(ros2):
    status, out, _ = ros2(
        "param", "list", "/sim_node", "--filter", "mass", "--param-prefixes", "sim"
    )
    assert (status, out) == (0, "  sim.disturbances.mass_error\n")


def test_a_parameter_is_shown(ros2):
    assert ros2("param", "get", "/turtlesim", "background_g") == (
        0,
        golden("param_get"),
        "",
    )


def test_a_parameter_is_set_and_dumped(ros2):
    done = ros2("param", "set", "/turtlesim", "background_r", "150")
    assert done == (0, "Set parameter successful\n", "")
    _, out, _ = ros2("param", "dump", "/turtlesim")
    assert yaml.safe_load(out)["/turtlesim"]["ros__parameters"]["background_r"] == 150


@pytest.mark.parametrize("value", ["256", "red"])
def test_a_value_that_a_node_does_not_take_is_refused_with_its_reason(ros2, value):
    status, out, err = ros2("param", "set", "/turtlesim", "background_b", value)
    assert (status, out) == (1, "")
    assert err.startswith("Setting parameter failed: ")
    assert "background_b" in err or "type" in err


def test_the_bipeds_parameters_stay_and_the_node_says_why(ros2):
    status, out, err = ros2("param", "set", "/sim_node", "seed", "3")
    assert (status, out) == (1, "")
    assert err.startswith("Setting parameter failed: ") and "seed" in err
    assert ros2("param", "get", "/sim_node", "seed")[1] == "Integer value is: 1\n"


def test_the_bipeds_parameters_are_described_with_units_and_ranges(ros2):
    status, out, _ = ros2("param", "describe", "/sim_node", "timeout_s")
    assert status == 0
    assert out.startswith("Parameter name: timeout_s\n  Type: double\n  Description: ")
    assert "[s]\n  Constraints:\n" in out and "    Min value: 0.0\n" in out


@pytest.fixture
def dumped(ros2, tmp_path):
    """Return a file with the simulation's parameters."""
    file = tmp_path / "sim.yaml"
    file.write_text(ros2("param", "dump", "/sim_node")[1])
    return file


def test_what_was_dumped_is_loaded_also_where_the_node_takes_no_changes(ros2, dumped):
    status, out, err = ros2("param", "load", "/sim_node", str(dumped))
    assert (status, err) == (0, "")
    assert "Set parameter use_sim_time successful\n" in out
    assert "Set parameter pace successful: unchanged\n" in out


def test_a_changed_file_is_loaded_as_far_as_the_node_takes_it(ros2, dumped):
    dumped.write_text(dumped.read_text().replace("pace: lockstep", "pace: realtime"))
    status, out, err = ros2("param", "load", "/sim_node", str(dumped))
    assert status == 1
    assert "Set parameter seed successful: unchanged\n" in out
    assert err.startswith("Set parameter pace failed: ") and err.count("\n") == 1


def test_a_parameter_is_deleted_where_its_node_lets_it_go(ros2):
    hidden = ("/_hidden", "--include-hidden-nodes")
    done = ros2("param", "delete", *hidden, "dynamic")
    assert done == (0, "Deleted parameter successfully\n", "")
    assert ros2("param", "get", *hidden, "dynamic")[0] == 1
    status, out, err = ros2("param", "delete", *hidden, "hostile")
    assert (status, out) == (1, "")
    assert err.startswith("Deleting parameter failed: ")


@pytest.mark.parametrize("verb", ["get", "describe", "dump"])
def test_texts_of_a_node_do_not_act_on_the_terminal(ros2, verb):
    name = [] if verb == "dump" else ["hostile"]
    status, out, _ = ros2("param", verb, "/_hidden", "--include-hidden-nodes", *name)
    assert status == 0
    assert "\\" in out
    assert out == printable(out, layout=True)


def test_a_service_is_described(ros2):
    assert ros2("service", "info", "/clear") == (0, golden("service_info"), "")


def test_calls_of_a_service_are_echoed(ros2, tmp_path):
    shown = tmp_path / "shown"
    with shown.open("w") as file:
        echo = subprocess.Popen([*COMMAND, "service", "echo", "/_switch"], stdout=file)
    try:
        # Called again and again, for nobody knows when it has begun to listen.
        whole, end = "", time.monotonic() + TIMEOUT_S
        while "REQUEST_RECEIVED" not in whole and time.monotonic() < end:
            assert echo.poll() is None
            ros2("service", "call", "/_switch", "std_srvs/srv/SetBool", "{data: true}")
            whole = shown.read_text().rpartition("---\n")[0]
        echo.send_signal(signal.SIGINT)
        assert echo.wait(TIMEOUT_S) == 130
    finally:
        echo.kill()
        echo.wait(TIMEOUT_S)
    events = whole.split("---\n")
    received = next(event for event in events if "REQUEST_RECEIVED" in event) + "---\n"
    received = re.sub(r"(sec|nanosec|sequence_number): \d+", r"\1: <NUMBER>", received)
    received = re.sub(r"client_gid:\n(  - \d+\n)+", "client_gid: <GID>\n", received)
    assert received == golden("service_echo")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("node info /nobody", "Unable to find node '/nobody'"),
        ("param get /nobody x --timeout 0.1", "Node not found"),
        ("param get /sim_node nothing", "Parameter not set"),
        ("param describe /sim_node nothing", "Parameter not set"),
        ("service info /nobody --spin-time 0.2", "Unknown service '/nobody'"),
        (
            "service call /nobody std_srvs/srv/Empty --timeout 0.1",
            "Service '/nobody' is not available",
        ),
        (
            "service call /no-where std_srvs/srv/Empty",
            "Invalid service name: topic name must not contain characters other than "
            "alphanumerics, '_', '~', '{', or '}': '/no-where'",
        ),
    ],
)
def test_what_is_not_there_is_one_line(settled, arguments, message):
    status, _, err = settled(
        *arguments.split(), until=lambda done: done[2] == f"{message}\n"
    )
    assert (status, err) == (1, f"{message}\n")


def test_an_unknown_service_fails_in_silence(ros2):
    assert ros2("service", "type", "/nobody") == (1, "", "")


def test_a_doctor_finds_the_twins(settled):
    found = "UserWarning: ERROR: 2 nodes share the name /twin"
    status, out, err = settled("doctor", until=lambda done: found in done[2])
    assert status == 1
    assert found in err
    assert "/9 checks failed\n\nFailed modules: " in out


def test_a_greeting_goes_over_ros_and_over_multicast(ros2):
    status, out, err = ros2("doctor", "hello", "--once")
    if err.startswith("multicast"):
        pytest.skip(f"this machine has no {err.strip()}")
    assert (status, err) == (0, "")
    assert "Topic: /canyouhearme, Published Msg Count: 1\n" in out
    assert "Multicast Group/Port: 225.0.0.1/49150, Sent Msg Count: 1\n" in out


def test_as_a_process_a_verb_ends_with_its_status(ros2):
    done = subprocess.run(
        [*COMMAND, "param", "get", "/turtlesim", "background_b"],
        env=os.environ,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
    )
    assert (done.returncode, done.stdout) == (0, "Integer value is: 255\n")


@pytest.mark.usefixtures("ros2")
@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("ros2 topic echo /biped/zmp", ["/biped/zmp", "/biped/zmp_reference"]),
        ("ros2 node info /t", ["/teleop_turtle", "/trajectory_node", "/turtlesim"]),
        (
            "ros2 param get /turtlesim background_",
            ["background_b", "background_g", "background_r"],
        ),
    ],
)
def test_names_on_the_graph_are_completed(tmp_path, line, names):
    offered = tmp_path / "offered"
    subprocess.run(
        COMMAND,
        env=os.environ
        | {
            "_ARGCOMPLETE": "1",
            "_ARGCOMPLETE_STDOUT_FILENAME": str(offered),
            "_ARGCOMPLETE_IFS": "\n",
            "COMP_LINE": line,
            "COMP_POINT": str(len(line)),
        },
        timeout=TIMEOUT_S,
    )
    assert [word.strip() for word in offered.read_text().split("\n")][:3] == names
