"""Live progress of a training run: one line on a terminal, plain lines elsewhere."""

from __future__ import annotations

import time
from types import TracebackType

from rich.console import Console
from rich.text import Text

from biped_bringup.cli.figures import figures_text
from biped_bringup.training import TrainingRun
from biped_common.live_display import LiveDisplay
from biped_common.timing import seconds

# How often a line is written where there is no terminal to redraw [s].
_PLAIN_INTERVAL_S = 10.0


class TrainingProgress(LiveDisplay):
    """Shows a run's state on standard error while it goes on."""

    def __init__(self, run: TrainingRun, console: Console) -> None:
        """Prepare; show nothing yet."""
        super().__init__(console, live=True, plain_interval_s=_PLAIN_INTERVAL_S)
        self._run = run
        self._since = time.monotonic()
        self._ticks_before = run.tally.simulated_ticks + run.tally.evaluation_ticks

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Leave the last state on the screen."""
        if not self.redraw(self._text):
            self._print_line()
        super().__exit__(kind, error, trace)

    def update(self) -> None:
        """Show the run as it stands."""
        if not self.redraw(self._text) and self.due():
            self._print_line()

    def _text(self) -> Text:
        return Text(self.line())

    def _print_line(self) -> None:
        self.console.print(self.line(), highlight=False, soft_wrap=True)

    def line(self) -> str:
        """Return the state in one line."""
        run = self._run
        schedule, tally = run.session.task.schedule, run.tally
        ticks = tally.simulated_ticks + tally.evaluation_ticks - self._ticks_before
        replayed = (
            f"replayed {100 * run.walker.ticks.replayed_share:.0f} %"
            if run.replay_off is None
            else "replay off"
        )
        rate = seconds(ticks) / max(time.monotonic() - self._since, 1e-9)
        return (
            f"target {seconds(schedule.target_ticks):5.2f} s"
            f"{' (whole walk, schedule complete)' if schedule.complete else ''}"
            f"  successes {schedule.successes}"
            f"  episodes {run.episodes}  survival {100 * run.log.survival():.0f} %"
            f"  {figures_text(run.session.learner.figures())}"
            f"  {replayed}  {rate:.1f} simulated s/s"
        )
