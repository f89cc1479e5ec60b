"""/diagnostics: what a node says of its rate, its lateness and what it refused."""

import msgspec
import pytest
from std_msgs.msg import String
from tests.graph.clients import TIMEOUT_S, Client, own_publisher, quick
from tests.robots import SHIPPED

from biped_bringup.one_executor import OneExecutor
from biped_ros.processor import ProcessorSettings
from msgs_json import topics
from msgs_json.observation import Observation
from msgs_json.wire import decode, encode
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

EPISODES = 3


def status_of(name):
    """Whether a message is that of a node; each says its own."""
    return lambda array: array.status[0].name == name


def observed(message):
    return decode(Observation, message.data)


def figures(array):
    return {pair.key: pair.value for pair in array.status[0].values}


@pytest.mark.parametrize("pace", ["lockstep", "realtime"])
def test_rate_lateness_and_deadlines_are_told(domain, pace):
    parameters = quick(pace=pace, max_episodes=EPISODES)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.DIAGNOSTICS) as client,
    ):
        found = figures(
            client.wait_for(
                topics.DIAGNOSTICS,
                lambda m: (
                    status_of("sim_node")(m)
                    and float(figures(m)["control ticks [Hz]"]) > 0.0
                ),
            )
        )
    ratio = float(found["simulated per real time"])
    assert ratio == pytest.approx(0.002 * float(found["control ticks [Hz]"]), abs=1e-3)
    assert int(found["missed 20 ms deadlines"]) >= 0
    assert float(found["observation to waist p50 [ms]"]) > 0.0
    assert ("control tick lateness p99 [ms]" in found) == (pace == "realtime")


def test_the_counts_are_those_of_the_run(domain):
    parameters = quick(max_episodes=EPISODES, listen_s=0.5)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.DIAGNOSTICS, topics.OBSERVATION) as client,
    ):
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == EPISODES, TIMEOUT_S)
        array = client.wait_for(topics.DIAGNOSTICS, status_of("learner_node"))
    found = figures(array)
    given_out = len(client.messages[topics.OBSERVATION.name])
    assert int(found["/biped/observation received"]) == given_out
    assert found["episodes"] == str(EPISODES)
    assert not [key for key in found if key.endswith((" refused", " malformed"))]
    assert not [key for key in found if key.endswith(" dropped")]


def test_messages_that_are_refused_and_that_never_came_are_told(domain):
    parameters = quick(max_episodes=1)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.DIAGNOSTICS, topics.OBSERVATION) as client,
    ):
        observations = client.messages[topics.OBSERVATION.name]
        # The learner is done after one walk, and the robot waits in the second one.
        assert graph.spin_until(
            lambda: observations and observed(observations[-1]).episode == 2, TIMEOUT_S
        )
        first, last = observed(observations[0]), observed(observations[-1])
        ahead = msgspec.structs.replace(
            last, control_tick=30, clock_ticks=last.clock_ticks + 30
        )
        publisher = own_publisher(graph, topics.OBSERVATION)
        for text in ("{", encode(first), encode(ahead)):
            publisher.publish(String(data=text))
        found = figures(
            client.wait_for(
                topics.DIAGNOSTICS,
                lambda m: (
                    status_of("trajectory_node")(m)
                    and "/biped/observation dropped" in figures(m)
                ),
            )
        )
    assert found["/biped/observation malformed"] == "1"
    assert found["/biped/observation dropped"] == "2"
    assert found["/biped/observation refused"] == "2"


def test_a_stance_that_no_leg_reaches_is_refused(domain):
    reference = WaistReference(SHIPPED, GaitSettings(), CorrectionSettings())
    plan = msgspec.structs.replace(reference.walk_plan(), waist_m=(0.0, 0.0, 5.0))
    with OneExecutor(quick(listen_s=60.0), domain) as graph:
        # Latched: whoever comes later hears the last one only.
        own_publisher(graph, topics.PLAN).publish(String(data=encode(plan)))
        assert graph.spin_until(
            lambda: graph.sim.counts["/biped/plan refused"] == 1, TIMEOUT_S
        )


def test_a_pace_that_cannot_be_kept_is_told_with_figure_and_advice(domain):
    parameters = quick(pace="realtime", realtime_factor=20.0)
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.DIAGNOSTICS) as client,
    ):
        array = client.wait_for(
            topics.DIAGNOSTICS,
            lambda m: (
                status_of("sim_node")(m)
                and "real time is not kept" in m.status[0].message
            ),
        )
    assert "20 asked for" in array.status[0].message
    assert "walk in lockstep, or slower with realtime_factor 10" in (
        array.status[0].message
    )


def test_what_the_machine_refuses_is_told_and_the_run_goes_on(domain):
    nowhere = ProcessorSettings(cores=(1023,))
    with (
        OneExecutor(quick(processor=nowhere), domain) as graph,
        Client(graph, topics.DIAGNOSTICS) as client,
    ):
        array = client.wait_for(topics.DIAGNOSTICS, status_of("sim_node"))
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes >= 1, TIMEOUT_S)
    assert "cores 1023 refused, goes on without" in array.status[0].message
