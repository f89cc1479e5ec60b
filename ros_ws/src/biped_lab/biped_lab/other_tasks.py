"""Tasks other than the walk: who learns them, and after how many episodes.

    python -m biped_lab.other_tasks examples/acrobot.py --seeds 10

The program named defines the task as `TASK`, a `biped_lab.control_task.ControlTask`.
Each arm learns it once per seed; every run is a line of a CSV file in `--out`, and is
not run again while it is there. Prints a table in Markdown of all runs in the file.
"""

from __future__ import annotations

import argparse
import csv
import math
import runpy
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from biped_common.command_line import CommandError, CommandParser, positive
from biped_common.errors import BipedError
from biped_common.settings import from_mapping, nested, overlay, to_mapping
from biped_lab import library_learners
from biped_lab.control_task import ControlTask, Learned, learn
from biped_lab.markdown import Table
from biped_lab.report.tables import NOTHING
from biped_lab.rivals.random_choice import RandomChoice
from biped_lab.statistics.comparison import compare
from learner_node.methods import MakeLearner, MethodSettings, make_learner

Run = Callable[[int], Learned]
"""Learns from nothing, with a seed."""

WITHOUT_FIXED_MODE = "XoL without fixed mode"
COLUMNS = ("arm", "seed", "reached", "episodes", "steps", "cpu_s")


def read_task(program: Path) -> ControlTask:
    """Return the `TASK` of a program.

    Raises:
        CommandError: it cannot be read, or has none.
    """
    try:
        task = runpy.run_path(str(program)).get("TASK")
    except OSError as error:
        raise CommandError(f"{program}: cannot be read ({error.strerror})") from None
    if not isinstance(task, ControlTask):
        raise CommandError(f"{program}: must define TASK, a ControlTask")
    return task


class Chance(RandomChoice):
    """Chooses by chance when it is tried, too."""

    def greedy(self, inputs: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return any action."""
        return self.choose()


def arms(task: ControlTask) -> dict[str, Run]:
    """Return who learns, by name."""

    def by(settings: MethodSettings, make: MakeLearner = make_learner) -> Run:
        return lambda seed: learn(task, settings, seed, make=make)

    def by_library(algorithm: str) -> Run:
        return lambda seed: library_learners.learn(task, algorithm, seed)

    xol = replace(task.settings, method="xol")
    never = nested("xol.fixed_mode.strategy", "none")
    without = from_mapping(MethodSettings, overlay(to_mapping(xol), never))
    found = {
        "XoL": by(xol),
        WITHOUT_FIXED_MODE: by(without),
        "Q(λ)": by(replace(xol, method="q_lambda")),
        "random choice": by(xol, lambda _, problem, rng: Chance(problem, rng)),
        "PPO": by_library("PPO"),
    }
    if task.make_continuous is not None:
        found["SAC"] = by_library("SAC")
    return found


def read_runs(file: Path) -> pd.DataFrame:
    """Return the runs that are in a file, `COLUMNS`; none where there is no file."""
    return pd.read_csv(file) if file.exists() else pd.DataFrame(columns=COLUMNS)


def append_run(file: Path, arm: str, seed: int, learned: Learned, cpu_s: float) -> None:
    """Append a run to a file."""
    begun = file.exists()
    with file.open("a", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        if not begun:
            writer.writerow(COLUMNS)
        writer.writerow((arm, seed, *learned, f"{cpu_s:.1f}"))


def table(runs: pd.DataFrame, task: ControlTask, rng: np.random.Generator) -> Table:
    """Return who learned the task, and what it took; medians are Kaplan-Meier's.

    The p-value is that of a difference in episodes to XoL without fixed mode.

    Args:
        runs: `COLUMNS`, in the order in which the arms are to come.
        task: has the bound.
        rng: draws permutations and bootstrap samples.
    """
    known = set(runs["arm"])
    baseline = WITHOUT_FIXED_MODE if WITHOUT_FIXED_MODE in known else None
    runs = runs.assign(state="finished", reached=runs["reached"].astype(bool))
    by_episodes = compare(
        runs.assign(time=runs["episodes"]), baseline, task.most_episodes, rng
    )
    # Who has not learned by the bound of episodes counts as longer than who has,
    # however short these were.
    most_steps = int(runs["steps"].max())
    times = runs["steps"].where(runs["reached"], most_steps)
    by_steps = compare(runs.assign(time=times), None, most_steps, rng)
    rows = []
    for (_, row), (_, steps) in zip(
        by_episodes.iterrows(), by_steps.iterrows(), strict=True
    ):
        rows.append(
            (
                row["arm"],
                f"{row['completed'] * row['n']:.0f} of {row['n']}",
                _median(row),
                _median(steps),
                NOTHING if math.isnan(row["p_holm"]) else f"{row['p_holm']:.2g}",
            )
        )
    head = ("learner", "learned", "episodes, median", "steps, median", "p (Holm)")
    return Table(head, tuple(rows))


def main() -> int:
    """Learn what has not been learned yet, and print."""
    parser = CommandParser(
        prog="python -m biped_lab.other_tasks", description=__doc__.splitlines()[0]
    )
    parser.add_argument("program", type=Path)
    parser.add_argument("--seeds", type=positive, default=10, metavar="N")
    parser.add_argument("--first", type=positive, default=8201, metavar="SEED")
    parser.add_argument("--arms", nargs="+", metavar="ARM", help="some of them only")
    parser.add_argument("--out", type=Path, default=Path("docs/results/other_tasks"))
    options = parser.parse_args()
    try:
        _run(options)
    except BipedError as error:
        parser.error(str(error))
    return 0


def _run(options: argparse.Namespace) -> None:
    task = read_task(options.program)
    ways = arms(task)
    names = options.arms or list(ways)
    for name in names:
        if name not in ways:
            raise CommandError(f"--arms {name}: must be among {', '.join(ways)}")
    options.out.mkdir(parents=True, exist_ok=True)
    file = options.out / f"{options.program.stem}.csv"
    done = {(row.arm, row.seed) for row in read_runs(file).itertuples()}
    for seed in range(options.first, options.first + options.seeds):
        for name in names:
            if (name, seed) not in done:
                started = time.process_time()
                learned = ways[name](seed)
                cpu_s = time.process_time() - started
                append_run(file, name, seed, learned, cpu_s)
                print(f"{name}, seed {seed}: {learned}", file=sys.stderr, flush=True)
    runs = read_runs(file)
    order = runs["arm"].map(list(ways).index)
    runs = runs.iloc[np.lexsort((runs["seed"], order))]
    print(table(runs, task, np.random.default_rng(1)).markdown(), end="")


def _median(row: pd.Series) -> str:
    value, low, high = (
        f"{number:,.0f}" if math.isfinite(number) else "∞"
        for number in row[["median", "median_low", "median_high"]]
    )
    return value if math.isnan(row["median_low"]) else f"{value} [{low}, {high}]"


if __name__ == "__main__":
    sys.exit(main())
