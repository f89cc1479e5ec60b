"""What `biped up` shows: one calm line on a terminal, plain lines elsewhere.

On a terminal the line tells how far the run is, and only what goes wrong is written
above it; what else nodes say is in their logs. Texts come from nodes, and through them
from anyone on the graph: nothing in them acts on the terminal.
"""

from __future__ import annotations

import time
from datetime import timedelta

from rich.console import Console
from rich.text import Text

from biped_bringup.cli.figures import figures_text
from biped_bringup.cli.run_figures import missed_deadlines, simulated_per_real_time
from biped_bringup.supervisor.child import Child
from biped_bringup.supervisor.graph_watch import NAME, GraphWatch
from biped_bringup.supervisor.supervisor import READY, Supervisor
from biped_common.live_display import LiveDisplay
from biped_common.terminal_text import printable
from msgs_json.learner_status import LearnerStatus

# How often the learner's state is written where there is no line to redraw [s].
_PLAIN_INTERVAL_S = 5.0
_WELL = "running"
"""What a node says in /diagnostics that has nothing to complain of."""
_BAR, _ASCII_BAR = ("━", "─"), ("#", "-")


class StatusScreen(LiveDisplay):
    """How far the run is, and the lines of its nodes."""

    def __init__(self, console: Console, live: bool) -> None:
        """Prepare; show nothing yet.

        Args:
            console: to write to.
            live: redraw one line, if the console is a terminal.
        """
        super().__init__(console, live, _PLAIN_INTERVAL_S)
        self._calm = live and console.is_terminal
        self._since = time.monotonic()

    def line(self, who: str, text: str) -> None:
        """Show a line of a node or of the supervisor."""
        # A warning is a remark, too, which stands below the line as long as it holds.
        told = text.startswith(("[INFO]", "[WARN]")) or (who == NAME and READY in text)
        if self._calm and told:
            return
        self.console.print(
            printable(f"[{who}] {text}"), markup=False, highlight=False, soft_wrap=True
        )

    def update(self, supervisor: Supervisor) -> None:
        """Show the state of the run."""
        if self.redraw(lambda: self._text(supervisor)):
            return
        status = supervisor.graph.status
        if status is not None and self.due():
            self.line("learner", f"{_progress(status)}  {figures_text(status.figures)}")

    def _text(self, supervisor: Supervisor) -> Text:
        graph, children = supervisor.graph, supervisor.children.values()
        absent = [each.name for each in children if each.name not in graph.remarks]
        state = f"starting {', '.join(absent)}" if absent else self._state(graph)
        late = missed_deadlines(graph)
        elapsed = timedelta(seconds=int(time.monotonic() - self._since))
        lines = [f"{state}  {elapsed}{f'  {late} deadlines missed' if late else ''}"]
        lines += [
            f"  {child.name}: {trouble}"
            for child in children
            if (trouble := _trouble(child, supervisor))
        ]
        # A line that wraps would leave its first half behind when it is redrawn.
        return Text(
            printable("\n".join(lines), layout=True), no_wrap=True, overflow="ellipsis"
        )

    def _state(self, graph: GraphWatch) -> str:
        status = graph.status
        if status is None:
            return "waiting for the learner"
        if status.frozen:
            speed = simulated_per_real_time(graph)
            return f"walking, nothing is learned  {speed} simulated s/s"
        full, empty = _ASCII_BAR if self.console.options.ascii_only else _BAR
        passed = status.subtasks if status.schedule_complete else status.subtask
        bar = full * passed + empty * max(status.subtasks - passed, 0)
        return (
            f"learning {bar} {status.target_time_s:.2f} s  episodes {status.episodes}  "
            f"survival {100 * status.survival:.0f} %"
        )


def _trouble(child: Child, supervisor: Supervisor) -> str:
    """Return what is wrong with a node; empty if nothing is known to be."""
    if child.name in supervisor.done_without:
        return supervisor.done_without[child.name]
    if child.exit_status:
        return f"ended with status {child.exit_status}"
    remark = supervisor.graph.remarks.get(child.name, _WELL)
    return remark if child.running and remark != _WELL else ""


def _progress(status: LearnerStatus) -> str:
    complete = " (schedule complete)" if status.schedule_complete else ""
    return (
        f"subtask {status.subtask + 1} of {status.subtasks}{complete}"
        f"  target {status.target_time_s:.2f} s  successes {status.successes}"
        f"  episodes {status.episodes}  survival {100 * status.survival:.0f} %"
    )
