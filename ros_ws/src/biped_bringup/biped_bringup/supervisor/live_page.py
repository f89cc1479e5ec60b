"""The live page beside a run: found by its entry point, started, and let die.

What failures do:
    no package offers a page: there is none, and nothing is said.
    it dies: it is started again after a growing pause, while nobody waits for it; the
        fifth time within ten seconds, or in a row, the run goes on without.
    it cannot start (its port was taken meanwhile): the run goes on without.
"""

from __future__ import annotations

import signal
import socket
import time
from collections.abc import Callable, Mapping
from pathlib import Path

from biped_bringup.supervisor.child import Child
from biped_bringup.supervisor.graph_watch import NAME
from biped_bringup.supervisor.restart_budget import RestartBudget
from biped_common.command_line import WRONG_INPUT
from biped_common.entry_points import entry_points

_GROUP, _NODE = "biped.nodes", "biped_view/view"
_HOST, _FIRST_PORT, _PORTS = "127.0.0.1", 8080, 100
_END_S = 5.0


class LivePage:
    """A page that shows the run, for as long as it can."""

    def __init__(
        self,
        environment: Mapping[str, str],
        folder: Path,
        memory_file: Path,
        show: Callable[[str, str], None],
    ) -> None:
        """Find the page and a port for it; start nothing yet.

        Args:
            environment: of the process.
            folder: for its log.
            memory_file: that the learner writes.
            show: told (who, line) of everything there is to tell.
        """
        self._show = show
        self._budget = RestartBudget()
        self._start_at: float | None = None
        """When it is to be started next; None: it runs, or is given up."""
        self._child: Child | None = None
        self.address: str | None = None
        point, port = entry_points(_GROUP).get(_NODE), _free_port()
        if point is None or port is None:
            return
        self.address = f"http://{_HOST}:{port}"
        self._child = Child(
            "view",
            point.module,
            ("--port", str(port), "--memory", str(memory_file)),
            environment,
            folder / "view.log",
            lambda _, line: None,
        )

    def start(self) -> None:
        """Start the page, and say where it is."""
        if self._child is not None:
            self._child.start()
            self._show(NAME, f"live page: {self.address}")

    def look_after(self) -> None:
        """Start the page again where it has died."""
        child = self._child
        if child is None or child.running:
            return
        now = time.monotonic()
        if self._start_at is None:
            delay_s = self._budget.failed(now)
            if delay_s is None or child.exit_status == WRONG_INPUT:
                self._show(NAME, f"no live page any more: {child.last_line}")
                self._child = self.address = None
                return
            self._start_at = now + delay_s
        if now >= self._start_at:
            self._start_at = None
            child.start()

    def stop(self) -> None:
        """End the page."""
        if self._child is not None:
            for number in (signal.SIGINT, signal.SIGKILL):
                self._child.signal(number)
                if self._child.wait(_END_S):
                    return


def _free_port() -> int | None:
    """Return the first port that a page can have here, if there is one."""
    for port in range(_FIRST_PORT, _FIRST_PORT + _PORTS):
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind((_HOST, port))
            except OSError:
                continue
            return port
    return None
