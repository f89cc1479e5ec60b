"""A node of the test's own beside those of a run: calls services, keeps messages."""

from collections import defaultdict

import rclpy

from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from biped_ros.messages import message_type
from biped_ros.qos import qos_profile

SEED = 5
TIMEOUT_S = 60.0


def quick(**changes):
    """Parameters of a short run that starts at once."""
    given = {"publish_every_ticks": 10, "listen_s": 0.0, "timeout_s": 60.0} | changes
    return node_parameters(load_settings("quick"), SEED, **given)


def hashes(session):
    """What was learned and what was walked."""
    return session.memory_sha256(), session.tally.trajectories_sha256


def learned_in_process(episodes):
    """The same of a run of plain calls."""
    run = TrainingRun(load_settings("quick"), SEED)
    run.run(episodes, False, lambda _: True)
    run.close()
    return hashes(run.session)


def own_publisher(graph, topic):
    """The publisher of a control topic's owner: what it sends is not a stranger's."""
    return next(
        publisher
        for node in graph.nodes
        if node.get_name() == topic.owner
        for publisher in node.publishers
        if publisher.topic_name == topic.name
    )


class Client:
    """Context manager around a node that is spun with a graph."""

    def __init__(self, graph, *topics):
        self.graph = graph
        self.messages = defaultdict(list)
        self._topics = topics

    def __enter__(self):
        self.node = rclpy.create_node("client", context=self.graph.sim.context)
        for topic in self._topics:
            self.node.create_subscription(
                message_type(topic),
                topic.name,
                self.messages[topic.name].append,
                qos_profile(topic),
            )
        self.graph.add(self.node)
        return self

    def __exit__(self, *_):
        self.graph.remove(self.node)
        self.node.destroy_node()

    def call(self, kind, name, **fields):
        """Return the response of a service."""
        client = self.node.create_client(kind, name)
        try:
            assert self.graph.spin_until(client.service_is_ready, TIMEOUT_S)
            future = client.call_async(kind.Request(**fields))
            assert self.graph.spin_until(future.done, TIMEOUT_S)
            return future.result()
        finally:
            self.node.destroy_client(client)

    def wait_for(self, topic, found):
        """Return the first message, of those to come, that is as wanted."""
        messages = self.messages[topic.name]
        start = len(messages)
        assert self.graph.spin_until(
            lambda: any(map(found, messages[start:])), TIMEOUT_S
        )
        return next(filter(found, messages[start:]))
