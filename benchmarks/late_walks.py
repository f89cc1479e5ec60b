"""Greedy walks in real time while other work takes cores: how many end as late.

`python -m benchmarks.late_walks` walks 20 with each remedy and 0, 1 and 2 cores taken,
which takes 80 minutes; `--walks`, `--taken` and `--remedies` choose less. A core is
taken by a process that does nothing but count.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from benchmarks.graph_run import Listener, run_graph
from biped_bringup.node_parameters import node_parameters
from biped_bringup.run_settings import load_settings
from biped_bringup.supervisor.supervisor import Supervisor
from biped_bringup.training import TrainingRun
from biped_ros.processor import ProcessorSettings
from msgs_json.end_cause import EndCause

_LAST_CORE = max(os.sched_getaffinity(0))
_REMEDIES: Mapping[str, Mapping[str, Any]] = {
    "none": {},
    "look-ahead 200": {"look_ahead_ticks": 200},
    "nice -10": {"processor": ProcessorSettings(nice=-10)},
    "fifo 50": {"processor": ProcessorSettings(fifo_priority=50)},
    "fifo 50, locked": {
        "processor": ProcessorSettings(fifo_priority=50, lock_memory=True)
    },
    "last core": {"processor": ProcessorSettings(cores=(_LAST_CORE,))},
    "factor 0.5": {"realtime_factor": 0.5},
}
_COUNT = "while True: pass"
_HEAD = ("taken", "remedy", "walks", "completed", "late", "other", "lost", "p99")
_ROW = "{:>5}  {:<16}{:>6}{:>11}{:>6}{:>7}{:>10}{:>10}"


def main() -> int:
    """Print a row per number of busy cores and remedy."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--walks", type=int, default=20)
    parser.add_argument("--taken", default="0,1,2", metavar="N,N")
    parser.add_argument(
        "--remedies", default=";".join(_REMEDIES), metavar="A;B", help="default: all"
    )
    options = parser.parse_args()
    remedies = options.remedies.split(";")
    if unknown := set(remedies) - set(_REMEDIES):
        parser.error(f"{', '.join(unknown)}: must be among {'; '.join(_REMEDIES)}")
    run = TrainingRun(load_settings("quick"), seed=0)
    run.run(None, False, lambda _: True)
    print(_ROW.format(*_HEAD), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        memory_file = Path(folder) / "memory.npz"
        run.save(memory_file)
        for taken in map(int, options.taken.split(",")):
            for remedy in remedies:
                with _taken(taken):
                    row = _walk(run, memory_file, options.walks, _REMEDIES[remedy])
                print(_ROW.format(taken, remedy, *row), flush=True)
    run.close()
    return 0


@contextmanager
def _taken(cores: int) -> Iterator[None]:
    """Keep so many cores busy."""
    busy = [subprocess.Popen([sys.executable, "-c", _COUNT]) for _ in range(cores)]
    try:
        yield
    finally:
        for process in busy:
            process.kill()
            process.wait()


def _walk(
    run: TrainingRun, memory_file: Path, walks: int, remedy: Mapping[str, Any]
) -> tuple[int | str, ...]:
    """Return walks, completed ones, late ones, others, time lost, answers' latency."""

    def walked(_: Supervisor, listener: Listener) -> bool:
        return len(listener.results) >= walks

    parameters = node_parameters(
        run.settings,
        run.seed,
        checkpoint_file=str(memory_file),
        pace="realtime",
        frozen=True,
        **remedy,
    )
    heard = run_graph(parameters.flat(), walked, timeout_s=60.0 * walks)
    causes = [result.end_cause for result in heard.results[:walks]]
    completed, late = causes.count(EndCause.COMPLETED), causes.count(EndCause.LATE)
    found = heard.figures
    return (
        walks,
        completed,
        late,
        walks - completed - late,
        f"{float(found['real time lost [ms]']):.0f} ms",
        f"{float(found['observation to waist p99 [ms]']):.1f} ms",
    )


if __name__ == "__main__":
    sys.exit(main())
