"""Call a service."""

from __future__ import annotations

import argparse
import math
import time
from typing import Any

from rclpy.node import Node

from ros2_verbs.errors import VerbError
from ros2_verbs.graph.endpoints import SERVICES
from ros2_verbs.graph.session import graph_node, spin, wait_until
from ros2_verbs.messages.fill import add_values_arguments, fill, given_values
from ros2_verbs.messages.text import to_yaml
from ros2_verbs.messages.types import interface_class
from ros2_verbs.options import add_node_arguments, completed, positive_float


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    SERVICES.add_name_argument(parser)
    completed(
        parser.add_argument("service_type", help="type, e.g. std_srvs/srv/SetBool"),
        SERVICES.complete_types,
    )
    add_values_arguments(
        parser,
        "what to fill the request with, in YAML, e.g. '{data: true}'; the rest keeps "
        "its defaults",
        _complete_request,
    )
    parser.add_argument(
        "-r",
        "--rate",
        metavar="N",
        type=positive_float,
        help="repeat the call at a specific rate in Hz",
    )
    parser.add_argument(
        "--timeout",
        metavar="N",
        type=positive_float,
        default=math.inf,
        help="give up when the service, or its answer, has not come after N seconds "
        "(default: wait for ever)",
    )
    SERVICES.add_hidden_argument(parser)
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Call once, or at a rate until interrupted.

    Raises:
        VerbError: the type or the values are wrong, or the service does not answer.
    """
    kind = interface_class(args.service_type, "srv")
    request = kind.Request()
    stamps = fill(request, given_values(args))
    with graph_node(args) as node:
        client = node.create_client(kind, args.service_name)
        # Ours has only just joined, so the first look sees nothing yet.
        if not wait_until(client.service_is_ready, args.spin_time):
            print("waiting for service to become available...")
            if not wait_until(client.service_is_ready, args.timeout):
                raise VerbError(f"Service '{args.service_name}' is not available")
        while True:
            began = time.monotonic()
            for stamp in stamps:
                stamp(node.get_clock().now().to_msg())
            _call(node, client, request, args.timeout)
            if args.rate is None:
                return 0
            time.sleep(max(0.0, began + 1.0 / args.rate - time.monotonic()))


def _call(node: Node, client: Any, request: Any, timeout_s: float) -> None:
    print(f"requester: making request: {request!r}\n")
    future = client.call_async(request)
    if not spin(node, future, timeout_s):
        raise VerbError(f"Service '{client.srv_name}' has not answered")
    print(f"response:\n{future.result()!r}\n")


def _complete_request(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    kind = interface_class(parsed_args.service_type, "srv")
    return [to_yaml(kind.Request(), flow_style=True)]
