"""How much more two workers of the laboratory do than one, and what they keep.

The same study, of runs that are about equally long and hardly replayed, is carried out
in two folders: by one worker and then by two, their start included (2 to 4 s). Only on
a machine with two idle cores is the ratio the laboratory's own.
"""

from __future__ import annotations

import resource
import statistics
import tempfile
import time
from collections.abc import Iterator, Sequence
from functools import partial
from multiprocessing import active_children
from pathlib import Path
from typing import NamedTuple

from benchmarks.report import Figure
from biped_lab.execution import Driver, new_stop_file, processes
from biped_lab.results import plan_study
from biped_lab.run_folder import is_done, read_cost
from biped_lab.study import study_of

_RUNS = 36
_STUDY = {
    "title": "two workers against one",
    "preset": "quick",
    "settings": {"learner.xol.fixed_mode.strategy": "none"},
    "most_episodes": 20,
    "seeds": {"first": 901, "count": _RUNS},
    "arms": {"none": None},
}
_TIMES_ONE_WORKER = 1.8
_GROWTH_MB = 1.0
_MEGABYTE = 1_000_000


class _CarriedOut(NamedTuple):
    """A study that some workers have carried out."""

    wall_s: float
    cpu_s: float
    """Of all runs, by their own account."""
    growth_mb: float
    """By which a worker grew with each run, after the first third of them."""


def measure() -> Iterator[Figure]:
    """Yield the ratios of two workers to one, and the growth of one."""
    one, two = (_carried_out(workers) for workers in (1, 2))
    yield Figure(f"laboratory, {_RUNS} runs, one worker", one.wall_s, "s")
    yield Figure(f"laboratory, {_RUNS} runs, two workers", two.wall_s, "s")
    yield Figure(
        "laboratory, two workers: times as fast as one",
        one.wall_s / two.wall_s,
        "",
        at_least=_TIMES_ONE_WORKER,
    )
    yield Figure(
        "laboratory, two workers: CPU time of the same runs, to one's",
        two.cpu_s / one.cpu_s,
        "",
    )
    yield Figure(
        "laboratory: growth of a worker with each run", one.growth_mb, "MB", _GROWTH_MB
    )


def _carried_out(workers: int) -> _CarriedOut:
    """Carry out the study in a new folder."""
    resident: list[tuple[int, float]] = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs = plan_study(folder, study_of("throughput", _STUDY))

        def watch() -> None:
            sizes = [_resident_mb(worker.pid) for worker in active_children()]
            resident.append((sum(map(is_done, runs)), max(sizes, default=0.0)))

        begun = time.monotonic()
        failures = Driver(
            partial(processes, workers), new_stop_file(folder), lambda: False, watch
        ).carry_out_all(runs)
        wall_s = time.monotonic() - begun
        if failures:
            raise RuntimeError(failures[0].reason)
        cpu_s = sum(read_cost(run).cpu_s for run in runs)
    return _CarriedOut(wall_s, cpu_s, _growth_mb(resident))


def _growth_mb(resident: Sequence[tuple[int, float]]) -> float:
    """Return the growth per run between the middle and the last third of the runs."""
    third = _RUNS // 3
    middle = [mb for done, mb in resident if third <= done < 2 * third]
    last = [mb for done, mb in resident if 2 * third <= done < _RUNS]
    return (statistics.median(last) - statistics.median(middle)) / third


def _resident_mb(process: int | None) -> float:
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text().split()[1])
    except (OSError, IndexError):  # it has just ended
        return 0.0
    return pages * resource.getpagesize() / _MEGABYTE
