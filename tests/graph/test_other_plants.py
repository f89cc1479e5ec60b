"""Another robot and another engine on the graph: the same walks as by plain calls."""

import pytest
from tests.graph.clients import SEED, TIMEOUT_S, Client, hashes
from tests.robots import EXAMPLES

from biped_bringup.node_parameters import node_parameters
from biped_bringup.one_executor import OneExecutor
from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from biped_description.robot import Robot
from msgs_json import topics

EPISODES = 4


@pytest.mark.parametrize(
    "settings",
    [
        load_settings("quick", EXAMPLES / "tall_robot.yaml"),
        load_settings("quick", None, ["sim.engine=kinematic"]),
        load_settings("quick", None, ["sim.engine=mujoco", "sim.servo.kind=pid"]),
    ],
    ids=["tall robot", "kinematic engine", "MuJoCo, PID servos"],
)
def test_the_graph_learns_what_plain_calls_learn(domain, settings):
    run = TrainingRun(settings, SEED)
    run.run(EPISODES, False, lambda _: True)
    run.close()
    parameters = node_parameters(
        settings, SEED, max_episodes=EPISODES, publish_every_ticks=10, listen_s=0.0
    )
    with (
        OneExecutor(parameters, domain) as graph,
        Client(graph, topics.ROBOT_DESCRIPTION, topics.TORSO_POSE) as client,
    ):
        session = graph.learner.session
        assert graph.spin_until(lambda: session.episodes == EPISODES, TIMEOUT_S)
        assert hashes(session) == hashes(run.session)
        (description,) = client.messages[topics.ROBOT_DESCRIPTION.name]
        assert description.data == Robot(settings.robot).urdf
        assert client.messages[topics.TORSO_POSE.name]
