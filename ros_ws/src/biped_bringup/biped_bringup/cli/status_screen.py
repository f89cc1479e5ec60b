"""What `biped up` shows: one live screen on a terminal, plain lines elsewhere.

Texts come from nodes, and through them from anyone on the graph: nothing in them acts
on the terminal.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterable
from datetime import timedelta

from rich.console import Console, Group
from rich.table import Table
from rich.text import Text

from biped_bringup.cli.figures import figures_text
from biped_bringup.cli.run_figures import missed_deadlines, simulated_per_real_time
from biped_bringup.supervisor.child import Child
from biped_bringup.supervisor.supervisor import Supervisor
from biped_common.live_display import LiveDisplay
from biped_common.terminal_text import printable
from biped_common.timing import seconds
from msgs_json.learner_status import LearnerStatus

# How often the learner's state is written where there is no screen to redraw [s].
_PLAIN_INTERVAL_S = 5.0
_REMEMBERED_EPISODES = 60
_LEVELS, _ASCII_LEVELS = "▁▂▃▄▅▆▇█", ".:-=+*#@"


class StatusScreen(LiveDisplay):
    """Nodes, learner and the last walk, next to the nodes' own lines."""

    def __init__(self, console: Console, live: bool, domain: int) -> None:
        """Prepare; show nothing yet.

        Args:
            console: to write to.
            live: redraw one screen, if the console is a terminal.
            domain: of the run.
        """
        super().__init__(console, live, _PLAIN_INTERVAL_S)
        self._domain = domain
        self._since = time.monotonic()
        self._episodes = -1
        self._survival: deque[float] = deque(maxlen=_REMEMBERED_EPISODES)

    def line(self, who: str, text: str) -> None:
        """Show a line of a node or of the supervisor."""
        self.console.print(
            printable(f"[{who}] {text}"), markup=False, highlight=False, soft_wrap=True
        )

    def update(self, supervisor: Supervisor, page: str | None) -> None:
        """Show the state of the run, and the address of its live page."""
        status = supervisor.graph.status
        if status is not None and status.episodes != self._episodes:
            self._episodes = status.episodes
            self._survival.append(status.survival)
        if self.redraw(lambda: self._screen(supervisor, page)):
            return
        if status is not None and self.due():
            self.line("learner", f"{_progress(status)}  {figures_text(status.figures)}")

    def _screen(self, supervisor: Supervisor, page: str | None) -> Group:
        graph = supervisor.graph
        table = Table("node", "process", "starts", "says")
        for child in supervisor.children.values():
            table.add_row(
                child.name,
                str(child.pid or "-"),
                str(child.starts),
                Text(printable(_says(child, supervisor))),
            )
        lines = ["learner    not heard yet"]
        if graph.status is not None:
            levels = _ASCII_LEVELS if self.console.options.ascii_only else _LEVELS
            lines = [
                f"learner    {_progress(graph.status)}",
                f"survival   {sparkline(self._survival, levels)}",
                f"memory     {figures_text(graph.status.figures)}; "
                f"{graph.status.simulated_s:.1f} s walked",
            ]
        elapsed = timedelta(seconds=int(time.monotonic() - self._since))
        lines.append(
            f"time       {elapsed} elapsed, {simulated_per_real_time(graph)} simulated "
            f"s/s, {missed_deadlines(graph)} deadlines missed"
        )
        if graph.result is not None:
            lines.append(
                f"last walk  {graph.result.end_cause} after "
                f"{seconds(graph.result.control_ticks):.2f} s, peak ZMP error "
                f"{1000 * graph.result.peak_zmp_error_m:.1f} mm"
            )
        if page is not None:
            lines.append(f"live page  {page}")
        lines.append(f"terminals  export ROS_DOMAIN_ID={self._domain}")
        return Group(table, Text(printable("\n".join(lines), layout=True)))


def sparkline(shares: Iterable[float], levels: str) -> str:
    """Return a character for each share of 1, out of those for the levels."""
    top = len(levels) - 1
    return "".join(levels[round(top * min(max(share, 0.0), 1.0))] for share in shares)


def _says(child: Child, supervisor: Supervisor) -> str:
    if child.running:
        return supervisor.graph.remarks.get(child.name, "not heard yet")
    if child.name in supervisor.done_without:
        return supervisor.done_without[child.name]
    status = child.exit_status
    if status is None:
        return "not started yet"
    return "ended" if status == 0 else f"ended with status {status}"


def _progress(status: LearnerStatus) -> str:
    complete = " (schedule complete)" if status.schedule_complete else ""
    return (
        f"subtask {status.subtask + 1} of {status.subtasks}{complete}"
        f"  target {status.target_time_s:.2f} s  successes {status.successes}"
        f"  episodes {status.episodes}  survival {100 * status.survival:.0f} %"
    )
