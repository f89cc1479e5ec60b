"""All that `ros2 doctor` looks at: the host, the installation, and the graph."""

from __future__ import annotations

import argparse
import os

import rclpy

from ros2_verbs.doctor import graph, host, installation
from ros2_verbs.doctor.area import Area
from ros2_verbs.environment import discovery_range
from ros2_verbs.graph.session import whole_graph


def examine(args: argparse.Namespace) -> list[Area]:
    """Return what was found, area by area."""
    environment = os.environ
    nodes, topics = whole_graph(
        args, lambda node: (graph.nodes_of(node), graph.topics_of(node))
    )
    middleware = rclpy.get_rmw_implementation_identifier()
    return [
        host.network_area(discovery_range(environment)),
        installation.package_area(),
        host.platform_area(),
        installation.ros_area(environment),
        host.shared_memory_area(),
        installation.middleware_area(middleware, environment),
        graph.node_area(nodes),
        graph.topic_area(topics),
        graph.qos_area(topics),
    ]
