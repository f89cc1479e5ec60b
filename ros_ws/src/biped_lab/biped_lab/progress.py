"""How far a study has come, and how much is left: a table, and lines elsewhere."""

from __future__ import annotations

import math
import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

from biped_common.live_display import LiveDisplay
from biped_lab.results import RUNS, read_study
from biped_lab.run_folder import (
    Cost,
    End,
    RunError,
    is_done,
    is_taken,
    read_cost,
    read_end,
)

_PLAIN_INTERVAL_S = 30.0


@dataclass(frozen=True)
class ArmProgress:
    """How far an arm has come."""

    name: str
    done: int
    running: int
    runs: int
    reached_at: Sequence[float]
    """Episodes to the goal, of the runs that are done; infinite: not reached."""
    cpu_s: Sequence[float]
    """Of each run that is done."""
    spent_s: float
    """Processor time of the runs that are not."""

    @property
    def waiting(self) -> int:
        """Runs that are neither done nor running."""
        return self.runs - self.done - self.running


class StudyWatch:
    """Looks at the folders of a study's runs; what is done is looked at once."""

    def __init__(self, folder: Path, name: str) -> None:
        """Read what was planned."""
        self.study = read_study(folder, name)
        self._runs = folder / RUNS
        self._done: dict[str, tuple[End, Cost]] = {}

    def arms(self) -> list[ArmProgress]:
        """Return how far each arm has come."""
        found = []
        for arm in self.study.arms:
            ended, running, spent_s = [], 0, 0.0
            for address in arm.runs.values():
                folder = self._runs / address
                try:
                    if address not in self._done and is_done(folder):
                        self._done[address] = (read_end(folder), read_cost(folder))
                    if address in self._done:
                        ended.append(self._done[address])
                    else:
                        running += is_taken(folder)
                        spent_s += read_cost(folder).cpu_s
                except RunError:
                    continue  # damaged; who carries it out or reads it says so
            at = [getattr(end, self.study.goal) for end, _ in ended]
            found.append(
                ArmProgress(
                    arm.name, len(ended), running, len(arm.runs),
                    [math.inf if n is None else n for n in at],
                    [cost.cpu_s for _, cost in ended], spent_s,
                )
            )  # fmt: skip
        return found


def left_s(arms: Sequence[ArmProgress]) -> float | None:
    """Return the processor time that is left; None while nothing is known.

    A run is taken to need what the median run of its arm has needed, or where none is
    done yet, the median run of all.
    """
    known = [s for arm in arms for s in arm.cpu_s]
    if not known:
        return None
    overall = statistics.median(known)
    return sum(
        max(
            0.0,
            (arm.runs - arm.done)
            * (statistics.median(arm.cpu_s) if arm.cpu_s else overall)
            - arm.spent_s,
        )
        for arm in arms
    )


def status_table(
    folder: Path, name: str, watch: StudyWatch | None = None, workers: int | None = None
) -> Table:
    """Return a table of arms, with a sum below.

    Args:
        folder: the laboratory's.
        name: of the study.
        watch: that has looked at it before.
        workers: among whom the time that is left is shared; None: it is given as
            processor time.
    """
    watch = watch or StudyWatch(folder, name)
    arms = watch.arms()
    table = Table(
        title=f"{watch.study.name}: {watch.study.title}", title_justify="left"
    )
    for column in ("arm", "done", "running", "waiting", "censored", "median episodes"):
        table.add_column(column, justify="left" if column == "arm" else "right")
    for arm in arms:
        table.add_row(
            arm.name, f"{arm.done} of {arm.runs}", str(arm.running), str(arm.waiting),
            str(arm.reached_at.count(math.inf)),
            _median(arm.reached_at),
        )  # fmt: skip
    table.caption = summary(arms, workers)
    table.caption_justify = "left"
    return table


def summary(arms: Sequence[ArmProgress], workers: int | None) -> str:
    """Return the whole study in a line."""
    done, runs = sum(a.done for a in arms), sum(a.runs for a in arms)
    running, left = sum(a.running for a in arms), left_s(arms)
    if done == runs:
        time_left = "nothing left"
    elif left is None:
        time_left = "time left: not known yet"
    elif workers is None:
        time_left = f"about {_duration(left)} of processor time left"
    else:
        time_left = f"about {_duration(left / min(workers, runs - done))} left"
    return f"{done} of {runs} runs done, {running} running; {time_left}"


class StudyProgress(LiveDisplay):
    """Shows a study while it is carried out."""

    def __init__(
        self, folder: Path, name: str, console: Console, workers: int | None
    ) -> None:
        """Prepare; show nothing yet."""
        super().__init__(console, live=True, plain_interval_s=_PLAIN_INTERVAL_S)
        self._folder, self._name, self._workers = folder, name, workers
        self._watch = StudyWatch(folder, name)

    def update(self) -> None:
        """Show the study as it stands."""
        if not self.redraw(self._table) and self.due():
            line = summary(self._watch.arms(), self._workers)
            self.console.print(f"{self._name}: {line}", soft_wrap=True)

    def _table(self) -> Table:
        return status_table(self._folder, self._name, self._watch, self._workers)


def _median(episodes: Sequence[float]) -> str:
    """Return the median in words; runs that were stopped took longer than all."""
    if not episodes:
        return "-"
    middle = statistics.median(episodes)
    return "beyond the bound" if math.isinf(middle) else f"{middle:g}"


def _duration(seconds: float) -> str:
    minutes = round(seconds / 60)
    if minutes < 1:
        return f"{seconds:.0f} s"
    return f"{minutes} min" if minutes < 90 else f"{minutes // 60} h {minutes % 60} min"
