"""A supervisor believes its own nodes, whoever else is on the graph."""

import time

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from msgspec.structs import replace
from std_msgs.msg import String
from tests.payloads import OBSERVATION, RESULT, STATUS
from tests.thorough import first_always

from biped_bringup.cli.run_figures import (
    counted,
    given_up_walks,
    missed_deadlines,
    not_saved_because,
    simulated_per_real_time,
)
from biped_bringup.supervisor.graph_watch import GraphWatch
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.wire import encode
from sim_node.realtime import MISSED_DEADLINES

OWN, OTHER = "host:12", "host:13"
TIMEOUT_S = 20.0
# Long enough for a message that will be heard to be heard.
SPOKEN_S = 0.5


class Speaker:
    """Says what a learner and a robot would say."""

    def __init__(self, learner, robot):
        self.publishers = [
            node.create_publisher(kind, topic.name, qos_profile(topic))
            for node, topic, kind in (
                (learner, topics.LEARNER_STATUS, String),
                (learner, topics.EPISODE, String),
                (learner, topics.DIAGNOSTICS, DiagnosticArray),
                (robot, topics.OBSERVATION, String),
            )
        ]
        self._status, self._episode, self._diagnostics, self._observed = self.publishers

    def status(self, process, **changes):
        status = replace(STATUS, instance=f"learner-1-{process}", **changes)
        self._status.publish(String(data=encode(status)))

    def episode(self, number, **changes):
        result = replace(RESULT, episode=number, **changes)
        self._episode.publish(String(data=encode(result)))

    def observation(self, number, **changes):
        """What the robot saw at the end of the walk of that number."""
        last = replace(
            OBSERVATION,
            episode=number,
            control_tick=RESULT.control_ticks,
            trajectory_sha256=RESULT.trajectory_sha256,
        )
        self._observed.publish(String(data=encode(replace(last, **changes))))

    def diagnostics(self, process, node=topics.LEARNER_NODE, **figures):
        values = [KeyValue(key=k, value=v) for k, v in figures.items()]
        status = DiagnosticStatus(name=node, hardware_id=process, values=values)
        self._diagnostics.publish(DiagnosticArray(status=[status]))


@pytest.fixture
def watch(domain):
    watch = GraphWatch(domain)
    yield watch
    watch.close()


@pytest.fixture
def speaker(domain, watch):
    """Return a speaker whom the watch hears, of a learner that is not expected."""
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    nodes = [
        rclpy.create_node(name, context=context)
        for name in (topics.LEARNER_NODE, topics.SIM_NODE)
    ]
    speaker = Speaker(*nodes)
    assert hears(
        watch, lambda: all(p.get_subscription_count() for p in speaker.publishers)
    )
    speaker.status(OTHER)
    speaker.diagnostics(OTHER)
    assert hears(watch, lambda: watch.status and watch.has_node(topics.LEARNER_NODE))
    yield speaker
    for node in nodes:
        node.destroy_node()
    rclpy.shutdown(context=context)


def hears(watch, condition):
    """Return whether the condition came true in time."""
    end = time.monotonic() + TIMEOUT_S
    while not condition() and time.monotonic() < end:
        watch.spin(0.05)
    return condition()


def test_a_walk_has_ended_when_robot_and_learner_say_so(watch, speaker):
    speaker.observation(7)
    speaker.episode(7)
    assert hears(watch, lambda: watch.results == 1)
    assert watch.result.episode == 7


def test_the_robot_may_be_heard_after_the_learner(watch, speaker):
    speaker.episode(7)
    watch.spin(SPOKEN_S)
    assert watch.results == 0
    speaker.observation(7)
    assert hears(watch, lambda: watch.results == 1)


@pytest.mark.parametrize(
    "other",
    first_always(
        [
            {"episode": 6},
            {"control_tick": RESULT.control_ticks - 10},
            {"trajectory_sha256": "0" * 64},
        ]
    ),
)
def test_a_result_that_the_robot_does_not_bear_out_is_none(watch, speaker, other):
    speaker.observation(7, **other)
    speaker.episode(7)
    assert hears(watch, lambda: watch.unseen is not None)
    assert watch.results == 0


def test_a_learner_that_was_expected_from_here_is_not_ready_when_another_is(
    watch, speaker
):
    watch.expect(topics.LEARNER_NODE, OWN)
    speaker.diagnostics(OTHER)
    watch.spin(SPOKEN_S)
    assert not watch.has_node(topics.LEARNER_NODE)
    speaker.diagnostics(OWN)
    assert hears(watch, lambda: watch.has_node(topics.LEARNER_NODE))


def test_what_another_learner_has_learned_is_not_this_ones(watch, speaker):
    watch.status = None
    watch.expect(topics.LEARNER_NODE, OWN)
    speaker.status(OTHER, learned=True)
    watch.spin(SPOKEN_S)
    assert watch.status is None
    speaker.status(OWN)
    assert hears(watch, lambda: watch.status is not None)
    assert not watch.status.learned


def test_what_a_second_learner_says_is_not_believed_and_it_is_named(
    watch, speaker, domain
):
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    forger = rclpy.create_node("forger", context=context)
    try:
        forged = Speaker(forger, forger)
        episode = topics.EPISODE.name
        assert hears(
            watch, lambda: "forger (this host)" in watch.strangers.get(episode, "")
        )
        forged.observation(8)
        forged.episode(8)
        forged.status(OTHER, learned=True)
        watch.spin(SPOKEN_S)
        assert (watch.results, watch.unseen, watch.status.learned) == (0, None, False)
    finally:
        forger.destroy_node()
        rclpy.shutdown(context=context)
    watch.spin(SPOKEN_S)
    speaker.observation(9)
    speaker.episode(9)
    assert hears(watch, lambda: watch.results == 1)


def test_a_node_meets_its_predecessor_for_a_while_and_that_is_no_stranger(
    watch, speaker, domain
):
    watch.expect(topics.LEARNER_NODE, OWN)
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    anew = rclpy.create_node(topics.LEARNER_NODE, context=context)
    try:
        publisher = anew.create_publisher(
            String, topics.EPISODE.name, qos_profile(topics.EPISODE)
        )
        watch.spin(SPOKEN_S)
        publisher.publish(String(data=encode(RESULT)))
        watch.spin(SPOKEN_S)
    finally:
        anew.destroy_node()
        rclpy.shutdown(context=context)
    assert topics.EPISODE.name not in watch.strangers


def test_what_a_node_is_to_publish_may_be_taken(watch, speaker):
    assert watch.taken(topics.TRAJECTORY_NODE) is None
    assert "published already by learner_node (this host)" in watch.taken(
        topics.LEARNER_NODE
    )


def test_walks_that_were_given_up_are_counted_by_cause(watch, speaker):
    causes = [EndCause.LATE, EndCause.ZMP_ERROR, EndCause.COMPLETED, EndCause.LATE]
    for number, cause in enumerate([*causes, EndCause.DISTURBED]):
        speaker.observation(number)
        speaker.episode(number, end_cause=cause)
        assert hears(watch, lambda number=number: watch.results == number + 1)
    assert counted(given_up_walks(watch)) == "late 2, disturbed 1"


def test_deadlines_are_counted_over_all_processes_of_the_robot(watch, speaker):
    for process, missed in ((OTHER, "2"), (OTHER, "3"), (OWN, "4")):
        watch.expect(topics.SIM_NODE, process)
        figures = {MISSED_DEADLINES: missed}
        speaker.diagnostics(process, topics.SIM_NODE, **figures)
        assert hears(watch, lambda: topics.SIM_NODE in watch.heard_at)
    assert missed_deadlines(watch) == 3 + 4


def test_figures_that_are_no_numbers_are_passed_over(watch, speaker):
    for process, missed in ((OWN, "2"), (OTHER, "many"), ("host:14", "9" * 5000)):
        watch.expect(topics.SIM_NODE, process)
        speaker.diagnostics(process, topics.SIM_NODE, **{MISSED_DEADLINES: missed})
        assert hears(watch, lambda: topics.SIM_NODE in watch.heard_at)
    assert missed_deadlines(watch) == 2


def test_before_nodes_are_heard_nothing_is_measured(watch):
    assert missed_deadlines(watch) == 0
    assert simulated_per_real_time(watch) == "-"
    assert not_saved_because(watch) == ""
