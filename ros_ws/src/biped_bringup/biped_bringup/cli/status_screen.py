"""What `biped up` shows: one live screen on a terminal, plain lines elsewhere."""

from __future__ import annotations

from rich.console import Console, Group
from rich.table import Table
from rich.text import Text

from biped_bringup.cli.figures import figures_text
from biped_bringup.supervisor.supervisor import Supervisor
from biped_common.live_display import LiveDisplay
from biped_common.timing import seconds
from msgs_json.learner_status import LearnerStatus

# How often the learner's state is written where there is no screen to redraw [s].
_PLAIN_INTERVAL_S = 5.0


class StatusScreen(LiveDisplay):
    """Nodes, learner and the last walk, next to the nodes' own lines."""

    def __init__(self, console: Console, live: bool) -> None:
        """Prepare; show nothing yet.

        Args:
            console: to write to.
            live: redraw one screen, if the console is a terminal.
        """
        super().__init__(console, live, _PLAIN_INTERVAL_S)

    def line(self, who: str, text: str) -> None:
        """Show a line of a node or of the supervisor."""
        self.console.print(
            f"[{who}] {text}", markup=False, highlight=False, soft_wrap=True
        )

    def update(self, supervisor: Supervisor) -> None:
        """Show the state of the run."""
        if self.redraw(lambda: _screen(supervisor)):
            return
        status = supervisor.graph.status
        if status is not None and self.due():
            self.line("learner", _learner_line(status))


def _screen(supervisor: Supervisor) -> Group:
    table = Table("node", "process", "starts", "says")
    for child in supervisor.children.values():
        table.add_row(
            child.name,
            str(child.pid or "-"),
            str(child.starts),
            supervisor.graph.remarks.get(child.name, "not heard yet"),
        )
    status, result = supervisor.graph.status, supervisor.graph.result
    lines = [
        _learner_line(status) if status is not None else "learner: not heard yet",
        (
            f"walk {result.episode}: {result.end_cause} after "
            f"{seconds(result.control_ticks):.2f} s, peak ZMP error "
            f"{1000 * result.peak_zmp_error_m:.1f} mm"
            if result is not None
            else "no walk has ended yet"
        ),
    ]
    return Group(table, Text("\n".join(lines)))


def _learner_line(status: LearnerStatus) -> str:
    return (
        f"target {status.target_time_s:.2f} s"
        f"{' (schedule complete)' if status.schedule_complete else ''}"
        f"  successes {status.successes}  episodes {status.episodes}"
        f"  survival {100 * status.survival:.0f} %"
        f"  {figures_text(status.figures)}"
    )
