"""Call a service."""

from __future__ import annotations

import argparse
import sys
import time
from typing import Any

from rclpy.node import Node

from ros2_verbs.arguments import positive_float
from ros2_verbs.completion import completed
from ros2_verbs.errors import VerbError
from ros2_verbs.graph_node import (
    add_node_arguments,
    graph_node,
    spin,
    wait_until,
)
from ros2_verbs.message_fill import fill, values_of
from ros2_verbs.message_types import service_class
from ros2_verbs.message_yaml import to_yaml
from ros2_verbs.service_names import (
    add_hidden_argument,
    complete_service_names,
    complete_service_types,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    completed(
        parser.add_argument(
            "service_name", help="service to call (e.g. '/sim_node/pause')"
        ),
        complete_service_names,
    )
    completed(
        parser.add_argument(
            "service_type", help="type of the service (e.g. 'std_srvs/srv/SetBool')"
        ),
        complete_service_types,
    )
    values = parser.add_mutually_exclusive_group()
    completed(
        values.add_argument(
            "values",
            nargs="?",
            default="{}",
            help="what to fill the request with, in YAML (e.g. '{data: true}'); the "
            "rest keeps its defaults",
        ),
        _complete_request,
    )
    values.add_argument(
        "--stdin", action="store_true", help="read the values from standard input"
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
        help="give up when the service, or its answer, has not come after N seconds "
        "(default: wait for ever)",
    )
    add_hidden_argument(parser)
    add_node_arguments(parser)


def main(args: argparse.Namespace) -> int:
    """Call once, or at a rate until interrupted.

    Raises:
        VerbError: the type or the values are wrong, or the service does not answer.
    """
    kind = service_class(args.service_type)
    request = kind.Request()
    now_fields = fill(
        request, values_of(sys.stdin.read() if args.stdin else args.values)
    )
    with graph_node(args) as node:
        client = node.create_client(kind, args.service_name)
        if not client.service_is_ready():
            # Ours has only just joined, so the first look sees nothing yet.
            if not wait_until(client.service_is_ready, args.spin_time):
                print("waiting for service to become available...")
            left_s = float("inf") if args.timeout is None else args.timeout
            if not wait_until(client.service_is_ready, left_s):
                raise VerbError(f"Service '{args.service_name}' is not available")
        while True:
            began = time.monotonic()
            for stamp in now_fields:
                stamp(node.get_clock().now().to_msg())
            _call(node, client, request, args.timeout)
            if args.rate is None:
                return 0
            time.sleep(max(0.0, began + 1.0 / args.rate - time.monotonic()))


def _call(node: Node, client: Any, request: Any, timeout_s: float | None) -> None:
    print(f"requester: making request: {request!r}\n")
    future = client.call_async(request)
    if not spin(node, future, timeout_s):
        raise VerbError(f"Service '{client.srv_name}' has not answered")
    print(f"response:\n{future.result()!r}\n")


def _complete_request(parsed_args: argparse.Namespace, **_: Any) -> list[str]:
    return [to_yaml(service_class(parsed_args.service_type).Request(), flow_style=True)]
