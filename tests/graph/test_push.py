"""A push by hand: felt, and refused where something would be learned from it."""

from std_srvs.srv import SetBool
from tests.graph.clients import TIMEOUT_S, Client, quick

from biped_bringup.one_executor import OneExecutor
from msgs_json import topics

PUSH, FREEZE = "/sim_node/push", "/learner_node/freeze"


def test_a_push_is_felt_in_a_frozen_walk_and_refused_in_one_to_learn_from(domain):
    with (
        OneExecutor(quick(), domain) as graph,
        Client(graph, topics.EPISODE) as client,
    ):
        assert graph.spin_until(lambda: graph.learner.session.walking, TIMEOUT_S)
        refused = client.call(SetBool, PUSH, data=True)
        assert not refused.success
        assert "freeze the learner" in refused.message

        client.call(SetBool, FREEZE, data=True)
        alone = client.wait_for(topics.EPISODE, frozen)
        memory = graph.learner.session.memory_sha256()
        answer = pushed(graph, client)
        assert answer.message == "pushed to the left"
        result = client.wait_for(topics.EPISODE, frozen)
        assert digest(result) != digest(alone)
        assert graph.learner.session.memory_sha256() == memory


def pushed(graph, client):
    """Push as soon as the robot takes it."""
    while not (answer := client.call(SetBool, PUSH, data=True)).success:
        pass
    return answer


def frozen(message):
    return '"learning":false' in message.data


def digest(message):
    return message.data.partition('"trajectory_sha256":')[2][:66]
