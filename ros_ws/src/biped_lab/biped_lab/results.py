"""A laboratory's folder: what was planned for each study, and what has come of it.

runs/ADDRESS/       the runs (`run_folder`), shared by all studies
STUDY/study.json    what the study is, and which runs are its own
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pandas as pd
import pyarrow.parquet as pq

from biped_common.atomic_file import atomic_file
from biped_common.errors import BipedError
from biped_common.timing import seconds
from biped_lab.contestant import MILESTONES
from biped_lab.run_folder import (
    EPISODES_FILE,
    MEMORY_FILE,
    is_done,
    plan,
    read_cost,
    read_end,
)
from biped_lab.study import Goal, Leading, Study, Value, changed

STUDY_FILE, RUNS = "study.json", "runs"
STATE_FIGURES = ("basis_states", "fixed_states", "penalty_states")


class ResultsError(BipedError, ValueError):
    """A folder that holds no such study."""


class PlannedArm(msgspec.Struct, frozen=True):
    """An arm as it was planned."""

    name: str
    contestant: str
    options: dict[str, Any]
    settings: dict[str, Any]
    """Those that differ from the preset `paper`, by dotted key."""
    factors: dict[str, Value]
    runs: dict[str, str]
    """Addresses by seed."""


class PlannedStudy(msgspec.Struct, frozen=True):
    """A study as it was planned."""

    name: str
    title: str
    paper: str
    claim: str
    figure: Leading
    goal: Goal
    most_episodes: int
    baseline: str | None
    reduced: bool
    arms: tuple[PlannedArm, ...]
    source: str = ""
    """What the study is found by: its name, or a file; empty: nobody wrote it down."""
    first_seeds: int | None = None
    """How many an arm has at most, where not all were to be carried out yet."""


@dataclass(frozen=True)
class StudyResults:
    """A study and its runs."""

    study: PlannedStudy
    folder: Path
    """The laboratory's."""
    runs: pd.DataFrame
    """A row per run, by arm and seed: `_row` says which columns."""

    def run_folder(self, address: str) -> Path:
        """Return the folder of a run."""
        return self.folder / RUNS / address

    def episodes(self, address: str) -> pd.DataFrame:
        """Return the table of a run that has ended, a row per episode."""
        return _episodes(self.run_folder(address))

    def memory(self, address: str) -> Path | None:
        """Return the checkpoint of a run, None where it was not kept."""
        path = self.run_folder(address) / MEMORY_FILE
        return path if path.exists() else None


def plan_study(
    folder: Path, study: Study, first_seeds: int | None = None
) -> list[Path]:
    """Write down a study and its runs; return their folders, in their order.

    Args:
        folder: the laboratory's.
        study: that is to be carried out.
        first_seeds: no more than so many seeds of an arm, and those whose runs have
            ended already; None: all.
    """
    addresses: dict[str, dict[str, str]] = {arm.name: {} for arm in study.arms}
    now = {arm.name: arm.seeds[:first_seeds] for arm in study.arms}
    folders = []
    for arm, spec in study.specs():
        if spec.seed in now[arm] or is_done(folder / RUNS / spec.address):
            folders.append(plan(folder / RUNS, spec))
            addresses[arm][str(spec.seed)] = spec.address
    file = study.file
    planned = PlannedStudy(
        study.name, file.title, file.paper, file.claim, file.figure, file.goal,
        file.most_episodes, file.baseline, study.reduced,
        tuple(
            PlannedArm(
                arm.name, arm.contestant, arm.options, changed(arm, "paper"),
                arm.factors, addresses[arm.name],
            )
            for arm in study.arms
        ),
        study.source, first_seeds,
    )  # fmt: skip
    (folder / study.name).mkdir(parents=True, exist_ok=True)
    with atomic_file(folder / study.name / STUDY_FILE) as stream:
        stream.write(msgspec.json.format(msgspec.json.encode(planned), indent=1))
    return folders


def studies_of(folder: Path) -> list[str]:
    """Return the names of the studies in a laboratory's folder."""
    return sorted(path.parent.name for path in folder.glob(f"*/{STUDY_FILE}"))


def read_study(folder: Path, name: str) -> PlannedStudy:
    """Return a study as it was planned.

    Raises:
        ResultsError: it is not there, or not readable.
    """
    path = folder / name / STUDY_FILE
    try:
        return msgspec.json.decode(path.read_bytes(), type=PlannedStudy)
    except OSError:
        there = ", ".join(studies_of(folder)) or "none"
        raise ResultsError(f"{folder}: no study {name!r}; there: {there}") from None
    except (msgspec.DecodeError, RecursionError) as error:
        raise ResultsError(f"{path}: is not what a study wrote: {error}") from None


def read_results(folder: Path, name: str) -> StudyResults:
    """Return a study with all that has come of its runs so far.

    Raises:
        ResultsError: the study is not there, or not readable.
        RunError: a run's files are not readable.
    """
    study = read_study(folder, name)
    rows = [
        {"arm": arm.name, "seed": int(seed), "address": address}
        | _row(folder / RUNS / address, study.goal)
        for arm in study.arms
        for seed, address in arm.runs.items()
    ]
    runs = pd.DataFrame(rows)
    names = [arm.name for arm in study.arms]
    runs["arm"] = pd.Categorical(runs["arm"], names, ordered=True)
    for name in MILESTONES:
        runs[name] = runs[name].astype("Int64")
    return StudyResults(study, folder, runs)


def _row(folder: Path, goal: Goal) -> dict[str, Any]:
    """Return what there is to know of a run.

    state                   finished, or unfinished: then there is nothing else but cost
    episodes                learning episodes in all
    schedule, greedy        episodes at the milestone, NA where it was not reached
    reached, time           the goal was; episodes to it, or to the censoring
    simulated_s             of the learning episodes
    evaluation_s            of the frozen trials
    *_states                at the end, NaN where the contestant has none
    computed_s, replayed_s  simulated time by where it came from
    cpu_s, sittings         processor time; 1 sitting is a run without interruption
    """
    cost = read_cost(folder)
    row: dict[str, Any] = {
        "state": "finished" if is_done(folder) else "unfinished",
        "episodes": cost.episodes, "schedule": None, "greedy": None,
        "reached": False, "time": np.nan, "simulated_s": np.nan,
        "evaluation_s": np.nan, **dict.fromkeys(STATE_FIGURES, np.nan),
        "computed_s": seconds(cost.computed_ticks),
        "replayed_s": seconds(cost.replayed_ticks),
        "cpu_s": cost.cpu_s, "sittings": cost.sittings,
        "memory_sha256": "", "trajectory_sha256": "",
    }  # fmt: skip
    if not is_done(folder):
        return row
    end = read_end(folder)
    at: int | None = getattr(end, goal)
    last = _episodes(folder).iloc[-1]
    return row | {
        "episodes": end.episodes, "schedule": end.schedule, "greedy": end.greedy,
        "reached": at is not None, "time": end.episodes if at is None else at,
        "simulated_s": seconds(end.figures["simulated_ticks"]),
        "evaluation_s": seconds(end.figures["evaluation_ticks"]),
        **{name: float(last.get(name, np.nan)) for name in STATE_FIGURES},
        "memory_sha256": end.figures["memory_sha256"],
        "trajectory_sha256": end.figures["trajectory_sha256"],
    }  # fmt: skip


def _episodes(folder: Path) -> pd.DataFrame:
    path = folder / EPISODES_FILE
    try:
        return pq.read_table(path).to_pandas()
    except (OSError, ValueError) as error:
        raise ResultsError(f"{path}: cannot be read: {error}") from None
