"""Nodes for the verbs to look at, as a process: the biped's three, and a few others.

python -m tests.graph.ros2_nodes    # on ROS_DOMAIN_ID, until stdin is closed
"""

import os
import sys
import threading

from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.qos import qos_profile_services_default
from rclpy.service_introspection import ServiceIntrospectionState
from std_srvs.srv import Empty, SetBool

from biped_bringup.node_parameters import node_parameters
from biped_bringup.one_executor import OneExecutor
from biped_bringup.run_settings import load_settings

COLOURS = {"background_b": 255, "background_g": 86, "background_r": 69}
HOSTILE = "\x1b[2J\u202e歩行"
LONGEST_S = 600.0


def turtlesim(context):
    """Return a node with what turtlesim has of installed types."""
    node = Node("turtlesim", context=context)
    bounds = IntegerRange(from_value=0, to_value=255)
    for name, value in COLOURS.items():
        node.declare_parameter(name, value, ParameterDescriptor(integer_range=[bounds]))
    for service in ("/clear", "/reset"):
        node.create_service(Empty, service, lambda _, response: response)
    return node


def teleop(context):
    """Return a node with the parameters of turtlesim's."""
    node = Node("teleop_turtle", context=context)
    node.declare_parameter("scale_angular", 2.0)
    node.declare_parameter("scale_linear", 2.0)
    return node


def hidden(context):
    """Return a node with a parameter that comes and goes, and texts of an enemy's."""
    node = Node("_hidden", context=context)
    descriptor = ParameterDescriptor(description=HOSTILE)
    node.declare_parameter("hostile", HOSTILE, descriptor)
    node.declare_parameter("dynamic", 1, ParameterDescriptor(dynamic_typing=True))
    return node


def introspected(context):
    """Return a node whose service tells of its calls."""
    node = Node("_introspected", context=context)
    service = node.create_service(SetBool, "/_switch", lambda _, response: response)
    service.configure_introspection(
        node.get_clock(),
        qos_profile_services_default,
        ServiceIntrospectionState.CONTENTS,
    )
    return node


def main():
    """Spin the nodes until stdin is closed."""
    parameters = node_parameters(
        load_settings("quick"), seed=1, listen_s=0.0, publish_every_ticks=100
    )
    closed = threading.Event()

    def wait_for_end():
        sys.stdin.read()
        closed.set()

    threading.Thread(target=wait_for_end, daemon=True).start()
    with OneExecutor(parameters, int(os.environ["ROS_DOMAIN_ID"])) as graph:
        context = graph.sim.context
        others = [
            turtlesim(context),
            teleop(context),
            Node("twin", context=context),
            Node("twin", context=context),
            hidden(context),
            introspected(context),
        ]
        for node in others:
            graph.add(node)
        print("up", flush=True)
        graph.spin_until(closed.is_set, LONGEST_S)
        for node in others:
            graph.remove(node)
            node.destroy_node()


if __name__ == "__main__":
    main()
