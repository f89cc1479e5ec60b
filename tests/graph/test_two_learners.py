"""Corrections do not say from whom they are: with two learners nobody is followed."""

import msgspec
from std_msgs.msg import String
from tests.graph.clients import TIMEOUT_S, Client, quick
from tests.payloads import STATUS

from biped_bringup.one_executor import OneExecutor
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import decode, encode

# Names sort by the time of the start, and this one is later than any.
RIVAL = msgspec.structs.replace(STATUS, instance="learner-9", active=True)


def test_a_walk_with_two_learners_is_given_up_and_the_next_one_is_learned_from(domain):
    with (
        OneExecutor(quick(timeout_s=1.0), domain) as graph,
        Client(graph, topics.EPISODE) as client,
    ):
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes >= 1, TIMEOUT_S)
        publisher = client.node.create_publisher(
            String, topics.LEARNER_STATUS.name, qos_profile(topics.LEARNER_STATUS)
        )
        assert graph.spin_until(
            lambda: publisher.get_subscription_count() >= 2, TIMEOUT_S
        )
        publisher.publish(String(data=encode(RIVAL)))
        client.wait_for(
            topics.EPISODE,
            lambda m: decode(EpisodeResult, m.data).end_cause is EndCause.PEER_SILENT,
        )
        counts = graph.trajectory.counts
        assert counts["/biped/learner refused"] == 1
        assert counts["/biped/correction refused"] == 1
        walked = session.episodes
        assert graph.spin_until(lambda: session.episodes > walked, TIMEOUT_S)
