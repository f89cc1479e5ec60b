"""The graph in one executor leaves nothing behind, and nothing unsaved."""

import time

import rclpy
from tests.graph.clients import TIMEOUT_S, hashes, learned_in_process, quick

from biped_bringup.one_executor import OneExecutor


def test_who_has_left_is_not_on_the_graph_any_more(domain):
    with OneExecutor(quick(), domain) as graph:
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes >= 1, TIMEOUT_S)
        names = {node.get_name() for node in graph.nodes}
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("newcomer", context=context)
    time.sleep(1.0)  # announcements come ten times a second
    found = set(node.get_node_names())
    node.destroy_node()
    rclpy.shutdown(context=context)
    assert found & names == set()
    assert "newcomer" in found


def test_who_leaves_within_a_walk_has_saved_all_before_it(domain, tmp_path, training):
    memory = tmp_path / "memory.npz"
    with OneExecutor(quick(checkpoint_file=str(memory)), domain) as graph:
        session = graph.learner.session
        assert graph.spin_until(
            lambda: session.episodes == 3 and session.walking, TIMEOUT_S
        )
    saved = training(memory).session
    assert saved.episodes == 3
    assert hashes(saved) == learned_in_process(3)
