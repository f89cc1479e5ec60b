"""Echo a service.

What is echoed are the events that a client or a server publishes beside the service,
once its introspection is switched on.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Any

from rclpy.task import Future
from service_msgs.msg import ServiceEventInfo

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import SERVICES, topic_types
from ros2_verbs.graph.qos import add_qos_arguments, listening_profile
from ros2_verbs.graph.session import caught, discover, graph_node, spin
from ros2_verbs.messages.shown import add_shown_arguments, shown_of
from ros2_verbs.messages.text import plain_to_yaml, to_csv, to_plain
from ros2_verbs.messages.types import interface_class
from ros2_verbs.options import add_graph_arguments, completed

_EVENTS = "/_service_event"
_EVENT_NAMES = {
    getattr(ServiceEventInfo, name): name
    for name in (
        "REQUEST_SENT",
        "REQUEST_RECEIVED",
        "RESPONSE_SENT",
        "RESPONSE_RECEIVED",
    )
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    SERVICES.add_name_argument(parser)
    completed(
        parser.add_argument(
            "service_type", nargs="?", help="its type, e.g. std_srvs/srv/SetBool"
        ),
        SERVICES.complete_types,
    )
    parser.add_argument(
        "--csv", action="store_true", help="all fields, separated by commas"
    )
    add_shown_arguments(parser)
    add_qos_arguments(parser, "subscribe", "services_default")


def main(args: argparse.Namespace) -> int:
    """Print events until interrupted.

    Raises:
        VerbError: the type is wrong, or not known since there is no such service.
    """
    shown = shown_of(args)

    def show(event: Any) -> None:
        if args.csv:
            print(to_csv(event, shown))
            return
        plain = to_plain(event, shown)
        number = plain["info"]["event_type"]
        plain["info"]["event_type"] = _EVENT_NAMES.get(number, number)
        print(f"{plain_to_yaml(plain, args.flow_style)}---")

    topic = f"{args.service_name}{_EVENTS}"
    with graph_node(args) as node:

        def introspected() -> bool:
            return bool(topic_types(node, topic))

        def types() -> Sequence[str]:
            known = dict(SERVICES.known(node, hidden=True))
            given = args.service_type
            return [given] if given else known.get(args.service_name, [])

        discover(args, lambda: introspected() and bool(types()), at_once=True)
        if len(types()) != 1:
            raise VerbError("Could not load the type for the passed service")
        if not introspected():
            print(
                f"No publishers on topic '{topic}'; is service introspection on the "
                "client or server enabled?"
            )
        finished: Future = Future()
        node.create_subscription(
            interface_class(types()[0], "srv").Event,
            topic,
            caught(finished, show),
            listening_profile(node, topic, args),
        )
        spin(node, finished)
    return 0
