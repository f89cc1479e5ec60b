"""Output a service's type."""

from __future__ import annotations

import argparse

from ros2_verbs.completion import completed
from ros2_verbs.graph_node import add_graph_arguments, graph_node, wait_until
from ros2_verbs.node_names import LATE_S
from ros2_verbs.service_names import (
    add_hidden_argument,
    complete_service_names,
    service_names_and_types,
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the verb."""
    add_graph_arguments(parser)
    completed(
        parser.add_argument(
            "service_name", help="name of the service (e.g. '/sim_node/pause')"
        ),
        complete_service_names,
    )
    add_hidden_argument(parser)


def main(args: argparse.Namespace) -> int:
    """Print the types of a service; fail in silence when there is none, as Jazzy's."""
    types: list[str] = []

    def known() -> bool:
        services = service_names_and_types(node, hidden=args.include_hidden_services)
        types[:] = dict(services).get(args.service_name, [])
        return bool(types)

    with graph_node(args) as node:
        wait_until(known, max(LATE_S, args.spin_time))
    for kind in types:
        print(kind)
    return 0 if types else 1
