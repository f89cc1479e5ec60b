"""What the verbs share that list topics or services."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from typing import TypeVar

from rclpy.node import Node

from ros2_verbs.graph_node import (
    add_graph_arguments,
    discover,
    graph_node,
    settled,
)

_Listed = TypeVar("_Listed")


def add_listing_arguments(parser: argparse.ArgumentParser, things: str) -> None:
    """Add the options of the graph and --count-THINGS.

    Args:
        parser: of the verb.
        things: such as topics.
    """
    add_graph_arguments(parser)
    parser.add_argument(
        "-c",
        f"--count-{things}",
        dest="only_count",
        action="store_true",
        help=f"only display the number of {things} discovered",
    )


def listed(args: argparse.Namespace, look: Callable[[Node], _Listed]) -> _Listed:
    """Return what a look at the graph finds, once the graph has settled."""
    with graph_node(args) as node:
        discover(args, until=settled(node))
        return look(node)


def print_listed(args: argparse.Namespace, lines: Sequence[str]) -> None:
    """Print a line each, or how many there are."""
    for line in [str(len(lines))] if args.only_count else lines:
        print(line)
