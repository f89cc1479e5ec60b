"""With a second publisher of corrections nobody is followed."""

from geometry_msgs.msg import Vector3Stamped
from tests.graph.clients import TIMEOUT_S, Client, quick

from biped_bringup.one_executor import OneExecutor
from biped_ros.qos import qos_profile
from msgs_json import topics
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.wire import decode


def test_a_walk_with_a_rival_is_given_up_and_the_next_one_is_learned_from(domain):
    with (
        OneExecutor(quick(), domain) as graph,
        Client(graph, topics.EPISODE, topics.DIAGNOSTICS) as client,
    ):
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes >= 1, TIMEOUT_S)
        rival = client.node.create_publisher(
            Vector3Stamped, topics.CORRECTION.name, qos_profile(topics.CORRECTION)
        )
        client.wait_for(
            topics.EPISODE,
            lambda m: decode(EpisodeResult, m.data).end_cause is EndCause.DISTURBED,
        )
        walked = session.episodes
        client.wait_for(
            topics.DIAGNOSTICS,
            lambda m: any("client (this host)" in s.message for s in m.status),
        )
        assert session.episodes == walked
        client.node.destroy_publisher(rival)
        assert graph.spin_until(lambda: session.episodes > walked, TIMEOUT_S)
