"""The page of a graph as a process: `ros2 run biped_view view`, and the supervisor's.

It runs at the lowest priority: whoever walks comes first.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from pathlib import Path

from biped_common.command_line import DONE, WRONG_INPUT, CommandParser, tcp_port
from biped_common.errors import BipedError
from biped_common.signals import loading, stop_requests

with loading():
    from biped_ros.environment import refuse_security
    from biped_ros.process import bound_memory
    from biped_view.live.graph_source import GraphSource
    from biped_view.live.page import Page

_LOWEST = 19


def show_graph(
    domain: int, port: int | None, memory: Path | None, dark: bool = False
) -> None:
    """Serve the page of a graph until SIGINT or SIGTERM.

    Args:
        domain: of the graph.
        port: to serve on; None: the first free one.
        memory: file that the learner writes, if there is one here.
        dark: begin in the dark theme.

    Raises:
        PortError: the port is taken.
        NoSecurityError: DDS Security is asked for.
    """
    refuse_security()
    bound_memory()
    with stop_requests() as stops:
        page = Page(f"biped, domain {domain}", port, dark)
        source = GraphSource(page, domain, memory)
        print(f"page    {page.address}", flush=True)
        try:
            page.run(source.turn, lambda: bool(stops))
        finally:
            page.close()
            source.close()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the page as a process."""
    parser = CommandParser(prog="view", description="The live page of a graph.")
    parser.add_argument("--port", type=tcp_port, help="default: 8080, or the next free")
    parser.add_argument("--memory", type=Path, help="file that the learner writes")
    options = parser.parse_args(arguments)
    os.setpriority(os.PRIO_PROCESS, 0, _LOWEST)
    try:
        domain = int(os.environ.get("ROS_DOMAIN_ID") or 0)
        show_graph(domain, options.port, options.memory)
    except BipedError as error:
        print(f"cannot start: {error}", file=sys.stderr)
        return WRONG_INPUT
    return DONE


if __name__ == "__main__":
    sys.exit(main())
