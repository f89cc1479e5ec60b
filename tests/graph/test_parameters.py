"""The nodes' settings as ROS parameters, through the services of every ROS node."""

import os
import subprocess
import sys

import pytest
from rcl_interfaces.msg import Parameter as ParameterMessage
from rcl_interfaces.msg import ParameterType
from rcl_interfaces.srv import (
    DescribeParameters,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.parameter import Parameter
from tests.graph.clients import TIMEOUT_S, Client, hashes, learned_in_process, quick
from tests.graph.domains import MODULE, own_domain

from biped_bringup.one_executor import OneExecutor
from biped_common.settings import SettingsError
from learner_node.node import LearnerNode
from msgs_json import topics
from sim_node.node import SimNode
from trajectory_node.node import TrajectoryNode

EPISODES = 6
NODES = {
    "sim_node": SimNode,
    "trajectory_node": TrajectoryNode,
    "learner_node": LearnerNode,
}
ROS_OWN = {"use_sim_time", "start_type_description_service"}
LIVE = {
    "sim_node": {
        "realtime_factor",
        "publish_every_ticks",
        "markers_every_ticks",
        "timeout_s",
    },
    "trajectory_node": set(),
    "learner_node": {"checkpoint_every_episodes"},
}


@pytest.fixture(scope="module")
def standing():
    """A graph on which nobody walks, since the learner still listens."""
    with (
        OneExecutor(quick(listen_s=60.0), own_domain(MODULE)) as graph,
        Client(graph) as client,
    ):
        yield client


def message(name, value) -> ParameterMessage:
    return Parameter(name, value=value).to_parameter_msg()


def change(client, node, *values):
    """Return the results of setting parameters one by one."""
    return client.call(
        SetParameters,
        f"/{node}/set_parameters",
        parameters=[message(*value) for value in values],
    ).results


def descriptors(client, node):
    names = client.call(ListParameters, f"/{node}/list_parameters").result.names
    ours = sorted(set(names) - ROS_OWN)
    found = client.call(
        DescribeParameters, f"/{node}/describe_parameters", names=ours
    ).descriptors
    return dict(zip(ours, found, strict=True))


# -- descriptions ----------------------------------------------------------------------


@pytest.mark.parametrize("node", NODES)
def test_every_parameter_is_described(standing, node):
    found = descriptors(standing, node)
    assert found
    assert all(descriptor.description for descriptor in found.values())


@pytest.mark.parametrize("node", NODES)
def test_every_number_has_a_unit(standing, node):
    numbers = (ParameterType.PARAMETER_INTEGER, ParameterType.PARAMETER_DOUBLE)
    assert not [
        name
        for name, descriptor in descriptors(standing, node).items()
        if descriptor.type in numbers and not descriptor.description.endswith("]")
    ]


@pytest.mark.parametrize("node", NODES)
def test_only_what_no_walk_depends_on_can_be_changed(standing, node):
    found = descriptors(standing, node)
    assert {n for n, d in found.items() if not d.read_only} == LIVE[node]


def test_ranges_are_those_of_the_settings(standing):
    found = descriptors(standing, "sim_node")
    (factor,) = found["realtime_factor"].floating_point_range
    (every,) = found["publish_every_ticks"].integer_range
    assert (factor.from_value, factor.to_value) == (0.0, 20.0)
    assert (every.from_value, every.to_value) == (1, 1000)


def test_words_to_choose_from_are_listed(standing):
    pace = descriptors(standing, "sim_node")["pace"]
    assert pace.additional_constraints == "one of lockstep, realtime"


# -- changes ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("node", "name", "value", "said"),
    [
        ("sim_node", "seed", 3, "seed = 3: walks depend on it"),
        ("sim_node", "sim.limits.zmp_error_m", 0.1, "walks depend on it"),
        ("trajectory_node", "gait.steps", 3, "gait.steps = 3: walks depend on it"),
        ("sim_node", "timeout_s", -1.0, "timeout_s = -1.0: must be above 0.0 s"),
        ("sim_node", "timeout_s", float("nan"), "timeout_s = nan: must be a finite"),
        ("sim_node", "timeout_s", 3, "timeout_s = 3: must be a number with a dot, 3.0"),
        ("sim_node", "timeout_s", "x", "timeout_s = 'x': must be a number"),
        ("sim_node", "realtime_factor", 21.0, "must be at most 20.0"),
        ("sim_node", "publish_every_ticks", 0, "must be between 1 and 1000"),
        ("sim_node", "markers_every_ticks", True, "must be a whole number"),
        ("sim_node", "nonsense", 1, "nonsense = 1: unknown parameter"),
        ("learner_node", "checkpoint_every_episodes", 0, "must be at least 1 episodes"),
    ],
)
def test_a_change_that_is_refused_says_which_and_why(standing, node, name, value, said):
    (result,) = change(standing, node, (name, value))
    assert not result.successful
    assert result.reason.startswith(f"{name} = ")
    assert said in result.reason


def test_of_changes_one_by_one_the_sound_ones_are_made(standing):
    results = change(standing, "sim_node", ("timeout_s", 50.0), ("timeout_s", -1.0))
    assert [result.successful for result in results] == [True, False]
    assert standing.graph.sim.get_parameter("timeout_s").value == 50.0


def test_of_changes_together_all_are_made_or_none(standing):
    before = standing.graph.sim.get_parameter("timeout_s").value
    result = standing.call(
        SetParametersAtomically,
        "/sim_node/set_parameters_atomically",
        parameters=[message("timeout_s", 40.0), message("nonsense", 1)],
    ).result
    assert not result.successful
    assert standing.graph.sim.get_parameter("timeout_s").value == before


def test_what_every_ros_node_has_can_still_be_set(standing):
    assert change(standing, "sim_node", ("use_sim_time", False))[0].successful


def test_live_changes_take_effect_and_change_no_walk(domain):
    parameters = quick(max_episodes=EPISODES)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.MARKERS, topics.CLOCK) as client,
    ):
        client.wait_for(topics.MARKERS, lambda _: True)
        results = change(
            client,
            "sim_node",
            ("markers_every_ticks", 0),
            ("publish_every_ticks", 500),
        )
        assert all(result.successful for result in results)
        session = graph.learner.session
        walked = session.episodes
        assert graph.spin_until(lambda: session.episodes > walked, TIMEOUT_S)
        markers = len(client.messages[topics.MARKERS.name])
        assert graph.spin_until(lambda: session.episodes >= EPISODES, TIMEOUT_S)
        assert len(client.messages[topics.MARKERS.name]) == markers
        assert client.messages[topics.CLOCK.name][-1].clock.nanosec % 10**9 == 0
        assert hashes(session) == learned_in_process(EPISODES)


# -- requests that are too large -------------------------------------------------------


def test_a_request_for_too_many_descriptions_is_not_answered_in_earnest(standing):
    service = "sim_node/describe_parameters"
    names = ["timeout_s"] * 2000
    answer = standing.call(DescribeParameters, f"/{service}", names=names)
    assert list(answer.descriptors) == []
    assert standing.graph.sim.counts[f"{service} refused"] == 1


# -- the start -------------------------------------------------------------------------


@pytest.mark.parametrize("node", NODES)
def test_an_unknown_parameter_at_the_start_is_refused(standing, node):
    with pytest.raises(SettingsError, match=r"nonsense = 1: unknown key"):
        NODES[node](
            context=standing.graph.sim.context,
            parameter_overrides=[Parameter("nonsense", value=1)],
        )


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("sim.limits.nonsense", 1, r"sim\.limits\.nonsense = 1: unknown key"),
        ("timeout_s", -1.0, r"timeout_s = -1\.0: must be above 0\.0 s"),
        ("seed", "a", r"seed = 'a': must be a whole number"),
        ("sim", 3, r"sim = 3: must be a section of keys"),
    ],
)
def test_a_wrong_parameter_at_the_start_is_refused(standing, name, value, said):
    with pytest.raises(SettingsError, match=said):
        SimNode(
            context=standing.graph.sim.context,
            parameter_overrides=[Parameter(name, value=value)],
        )


@pytest.mark.parametrize("text", ["{", "[]", "3", ""])
def test_settings_of_the_run_that_are_no_json_object_are_refused(standing, text):
    with pytest.raises(SettingsError, match=r"^run_settings = .*: is not the JSON"):
        LearnerNode(
            context=standing.graph.sim.context,
            parameter_overrides=[Parameter("run_settings", value=text)],
        )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            "sim_node: {ros__parameters: {nonsense: 1}}",
            "cannot start: nonsense = 1: unknown key",
        ),
        ("sim_node: {ros__parameters: {seed: 1", "wrong arguments: "),
    ],
    ids=["unknown key", "no YAML"],
)
def test_a_node_ends_with_one_line_where_its_file_is_wrong(
    domain, tmp_path, text, said
):
    file = tmp_path / "parameters.yaml"
    file.write_text(text)
    ended = subprocess.run(
        [sys.executable, "-m", "sim_node.node", "--ros-args", "--params-file", file],
        env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        check=False,
    )
    lines = [line for line in ended.stderr.splitlines() if "[rcl" not in line]
    assert (ended.returncode, len(lines)) == (2, 1)
    assert lines[0].startswith(said)
