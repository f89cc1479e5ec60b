"""`biped view`: the live page of a graph, of a recorded walk, or of a memory."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from biped_common.command_line import DONE, CommandError, natural, positive, tcp_port
from biped_common.signals import stop_requests
from biped_ros.environment import LAST_DOMAIN, LOCALHOST, node_environment


def add_parser(verbs: Any, _: Sequence[str]) -> None:
    """Add the verb."""
    parser: argparse.ArgumentParser = verbs.add_parser(
        "view",
        help="a page that shows the robot walk and learn: graph, bag or memory",
        description="Serve a page on 127.0.0.1 that shows a running graph, or a walk "
        "of a bag or of a memory under a time slider, until Ctrl-C. Exit status 0, or "
        "2 for wrong input.",
    )
    parser.add_argument(
        "source",
        nargs="?",
        type=Path,
        metavar="BAG|RUN|MEMORY",
        help="a recorded walk, or a memory, which walks once; without it the graph of "
        "--domain is shown",
    )
    parser.add_argument(
        "--walk",
        type=positive,
        metavar="N",
        help="of a bag, 1 for its first (default: its last)",
    )
    parser.add_argument(
        "--domain",
        type=natural,
        metavar="ID",
        help="of the graph; default: ROS_DOMAIN_ID, or else 0",
    )
    parser.add_argument(
        "--memory",
        type=Path,
        metavar="FILE",
        help="the graph's memory file: states and former episodes, as of its last "
        "checkpoint",
    )
    parser.add_argument(
        "--port", type=tcp_port, metavar="N", help="default: 8080, or the next free one"
    )
    parser.add_argument("--dark", action="store_true", help="begin in the dark theme")
    parser.set_defaults(run=run)


def run(options: argparse.Namespace) -> int:
    """Serve the page."""
    if options.source is None:
        _show_graph(options)
    elif options.domain is not None or options.memory is not None:
        raise CommandError(f"{options.source}: --domain and --memory are for a graph")
    else:
        _show_walk(options)
    return DONE


def _show_graph(options: argparse.Namespace) -> None:
    domain = options.domain
    if domain is None:
        text = os.environ.get("ROS_DOMAIN_ID") or "0"
        domain = int(text) if text.isdecimal() else -1
    if not 0 <= domain <= LAST_DOMAIN:
        raise CommandError(f"--domain, ROS_DOMAIN_ID: must be from 0 to {LAST_DOMAIN}")
    # The middleware reads its profile once, before the first node.
    os.environ.update(node_environment(domain, LOCALHOST))
    from biped_view.live.node import show_graph

    show_graph(domain, options.port, options.memory, options.dark)


def _show_walk(options: argparse.Namespace) -> None:
    from biped_view.live.memory import show_memory
    from biped_view.live.page import Page
    from biped_view.live.record_source import RecordSource
    from biped_view.walk_sources import memory_of, read_walk

    record = read_walk(options.source, options.walk).record
    memory = memory_of(options.source)
    with stop_requests() as stops:
        page = Page(options.source.name, options.port, options.dark)
        print(f"page    {page.address}", flush=True)
        try:
            if memory is not None:
                show_memory(page, memory)
            source = RecordSource(page, record)
            page.run(source.turn, lambda: bool(stops))
        finally:
            page.close()
