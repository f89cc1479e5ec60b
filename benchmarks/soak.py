"""Learn in real time for ten minutes: what gets lost, what grows, what is left behind?

    python -m benchmarks.soak --minutes 10

All of `biped up` runs, recorder included, with the paper's settings. The bag is split,
since the index of an MCAP file stays in memory until the file is finished, 1.5 MB for a
minute of everything. Exit status 1 when a message was lost, a process grew by more than
2 % after its first minute, or something stayed in shared memory; 130 when interrupted.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path
from signal import SIGINT

from benchmarks.report import Figure
from benchmarks.up_run import UpRun, resident_kb, shared_memory, up, wait_until
from biped_bag.records import LOST_KEY
from biped_bag.storage.layout import holds_bag
from biped_bag.storage.metadata import read_metadata
from biped_bringup.supervisor.supervisor import START_ORDER
from biped_common.command_line import INTERRUPTED

_OPTIONS = ("--pace", "realtime", "--record-split", "size=2")
_GROWTH_BOUND_PERCENT = 2.0
_WARMING_UP_S = 60.0
_READY_S = 120.0
_LOOK_S = 1.0
_LOOKS_AVERAGED = 10
_SHOW_S = 30.0


class Sizes:
    """What the processes of a run take, look by look."""

    def __init__(self, run: UpRun) -> None:
        """Look at nothing yet."""
        self._run = run
        self._kb: defaultdict[tuple[str, int], list[int]] = defaultdict(list)

    def look(self) -> None:
        """Look at every process once."""
        for who in self._run.processes().items():
            taken = resident_kb(who[1])
            if taken is not None:
                self._kb[who].append(taken)

    def growth_percent(self) -> dict[str, float]:
        """Return by how much each process is larger than at its first looks."""
        return {
            f"{name} ({process})": 100.0 * (_ends(kb)[1] / _ends(kb)[0] - 1.0)
            for (name, process), kb in self._kb.items()
        }

    def line(self) -> str:
        """Return what each takes now."""
        return "  ".join(
            f"{name} {kb[-1] / 1024.0:.1f} MB" for (name, _), kb in self._kb.items()
        )


def _ends(kb: list[int]) -> tuple[float, float]:
    return (
        statistics.median(kb[:_LOOKS_AVERAGED]),
        statistics.median(kb[-_LOOKS_AVERAGED:]),
    )


def soak(folder: Path, minutes: float, seed: int) -> list[Figure]:
    """Run, watch, end; return what came of it.

    Raises:
        RuntimeError: the run did not come up, or ended by itself.
    """
    before = shared_memory()
    with up(folder, *_OPTIONS, "--seed", str(seed)) as run:
        if not wait_until(lambda: len(run.processes()) > len(START_ORDER), _READY_S):
            raise RuntimeError(f"not all nodes came up within {_READY_S:g} s")
        begun = time.monotonic()
        sizes = Sizes(run)
        shown_s = 0.0
        while (ran_s := time.monotonic() - begun) < 60.0 * minutes:
            time.sleep(_LOOK_S)
            if run.process.poll() is not None:
                raise RuntimeError(f"the run ended after {ran_s:.0f} s by itself")
            if ran_s < _WARMING_UP_S:
                continue
            sizes.look()
            if ran_s - shown_s >= _SHOW_S:
                shown_s = ran_s
                print(f"{ran_s:5.0f} s  {sizes.line()}", flush=True)
        run.end(SIGINT)
    bags = [bag for bag in sorted(folder.glob("bag_*")) if holds_bag(bag)]
    metadata = [read_metadata(bag) for bag in bags]
    lost = sum(int(of_bag.custom[LOST_KEY]) for of_bag in metadata)
    recorded = sum(of_bag.message_count for of_bag in metadata)
    growth = sizes.growth_percent()
    return [
        Figure("messages recorded", recorded, "", at_least=1.0),
        Figure("messages lost", lost, "", 0.0),
        *(
            Figure(f"growth of {who}", percent, "%", _GROWTH_BOUND_PERCENT)
            for who, percent in growth.items()
        ),
        Figure("processes at their first minute", len(growth), "", 5.0, 5.0),
        Figure("left in shared memory", len(shared_memory() - before), "", 0.0),
    ]


def main() -> int:
    """Soak and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    if 60.0 * options.minutes <= _WARMING_UP_S:
        parser.error(f"--minutes {options.minutes:g}: must be above 1")
    with tempfile.TemporaryDirectory() as name:
        try:
            figures = soak(Path(name), options.minutes, options.seed)
        except KeyboardInterrupt:
            return INTERRUPTED
        except RuntimeError as error:
            print(error, (Path(name) / "up.log").read_text(), sep="\n")
            return 1
    print("\n".join(figure.line() for figure in figures))
    return 0 if all(figure.kept for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
