"""Walk learned memories greedily on two engines, and see how far the walks agree.

    python -m biped_lab.engine_agreement bags/seeds/seed_31 bags/seeds/seed_32

Each folder holds a `memory.npz` of `biped learn`. The walks are closed loops: from the
first observation that leads to another correction, the motions differ, too. Prints a
table in Markdown, a row per memory, and a summary.
"""

from __future__ import annotations

import argparse
import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from biped_bringup.cli.learn import MEMORY_FILE
from biped_bringup.run_settings import changed_settings
from biped_bringup.training import TrainingRun
from biped_bringup.walker import Walker
from biped_common.errors import BipedError
from biped_common.timing import seconds
from biped_lab import markdown
from sim_node.control_tick import ControlTick
from sim_node.engines import ENGINES


@dataclass(frozen=True)
class GreedyWalk:
    """One memory's walk on one engine."""

    engine: str
    completed: bool
    end: str
    walked_s: float
    peak_zmp_error_m: float
    zmp_m: NDArray[np.float64]
    """(ticks, 2)"""
    joint_references: NDArray[np.float64]
    """(ticks, 12)"""


@dataclass(frozen=True)
class Agreement:
    """How two walks of one memory differ."""

    alike_s: float
    """Until then, the motions asked for are the same."""
    zmp_rms_alike_m: float
    """Difference of the ZMPs until then, root mean square of its norm."""
    zmp_rms_m: float
    """The same over all ticks that both walked."""


def walk(run: TrainingRun, engine: str) -> GreedyWalk:
    """Walk a run's memory greedily on an engine."""
    ticks: list[ControlTick] = []
    settings = changed_settings(run.settings, changes=[f"sim.engine={engine}"])
    walker = Walker(settings, np.random.default_rng(0), ticks.append)
    try:
        result = walker.walk(run.session.greedy())
    finally:
        walker.close()
    return GreedyWalk(
        engine=engine,
        completed=result.completed,
        end=str(result.end_cause),
        walked_s=seconds(result.control_ticks),
        peak_zmp_error_m=result.peak_zmp_error_m,
        zmp_m=np.array([tick.contact[:2] for tick in ticks]),
        joint_references=np.array([tick.joint_reference for tick in ticks]),
    )


def agreement(one: GreedyWalk, other: GreedyWalk) -> Agreement:
    """Compare two walks tick by tick, as far as both go."""
    ticks = min(len(one.zmp_m), len(other.zmp_m))
    asked = one.joint_references[:ticks], other.joint_references[:ticks]
    differing = np.flatnonzero((asked[0] != asked[1]).any(axis=1))
    alike = int(differing[0]) if len(differing) else ticks
    squares = ((one.zmp_m[:ticks] - other.zmp_m[:ticks]) ** 2).sum(axis=1)
    return Agreement(
        alike_s=seconds(alike),
        zmp_rms_alike_m=float(np.sqrt(squares[:alike].mean())) if alike else 0.0,
        zmp_rms_m=float(np.sqrt(squares.mean())),
    )


def main() -> int:
    """Walk, compare and print; exit status 2 where a memory cannot be read."""
    parser = argparse.ArgumentParser(
        prog="python -m biped_lab.engine_agreement", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR")
    parser.add_argument(
        "--engines", nargs=2, choices=ENGINES, default=("pybullet", "kinematic")
    )
    options = parser.parse_args()
    print(_table_head(options.engines))
    pairs = []
    for folder in options.folders:
        try:
            run = TrainingRun.load(folder / MEMORY_FILE)
            run.close()
            one, other = (walk(run, engine) for engine in options.engines)
        except BipedError as error:
            print(error, file=sys.stderr)
            return 2
        pairs.append((one, other))
        print(_row(folder.name, one, other), flush=True)
    print()
    for walks in zip(*pairs, strict=True):
        peak_mm = 1000 * statistics.median(each.peak_zmp_error_m for each in walks)
        print(
            f"{walks[0].engine}: {sum(each.completed for each in walks)} of "
            f"{len(walks)} completed, median peak ZMP error {peak_mm:.1f} mm"
        )
    return 0


def _table_head(engines: Sequence[str]) -> str:
    cells = ["memory"]
    for engine in engines:
        cells += [f"{engine}: walked [s]", "end", "peak ZMP error [mm]"]
    cells += ["same motion for [s]", "ZMPs apart then [mm rms]", "in all [mm rms]"]
    return markdown.head(cells)


def _row(name: str, one: GreedyWalk, other: GreedyWalk) -> str:
    cells = [name]
    for each in (one, other):
        cells += [
            f"{each.walked_s:g}", each.end, f"{1000 * each.peak_zmp_error_m:.1f}"
        ]  # fmt: skip
    found = agreement(one, other)
    cells += [
        f"{found.alike_s:g}",
        f"{1000 * found.zmp_rms_alike_m:.2f}",
        f"{1000 * found.zmp_rms_m:.2f}",
    ]
    return markdown.row(cells)


if __name__ == "__main__":
    sys.exit(main())
