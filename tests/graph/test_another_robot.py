"""A robot of another size on the graph: all nodes know the same one."""

from tests.graph.clients import SEED, TIMEOUT_S, Client, hashes
from tests.robots import EXAMPLES, TALL

from biped_bringup.node_parameters import node_parameters
from biped_bringup.one_executor import OneExecutor
from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from msgs_json import topics

EPISODES = 4
SETTINGS = load_settings("quick", EXAMPLES / "tall_robot.yaml")


def test_it_learns_as_it_does_by_plain_calls(domain):
    run = TrainingRun(SETTINGS, SEED)
    run.run(EPISODES, False, lambda _: True)
    run.close()
    parameters = node_parameters(
        SETTINGS, SEED, max_episodes=EPISODES, publish_every_ticks=10, listen_s=0.0
    )
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.ROBOT_DESCRIPTION) as client,
    ):
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == EPISODES, TIMEOUT_S)
        assert hashes(session) == hashes(run.session)
        (description,) = client.messages[topics.ROBOT_DESCRIPTION.name]
        assert description.data == TALL.urdf
