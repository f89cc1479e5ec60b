"""Results of made-up runs, in the layout of a laboratory's folder."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from biped_lab.results import PlannedArm, PlannedStudy, StudyResults
from biped_lab.run_folder import EPISODES_FILE
from biped_lab.study import Value

BOUND = 40
TICKS = 900
BY_K: Mapping[str, Mapping[str, Value]] = {
    "K = 1": {"K": 1},
    "K = 3": {"K": 3},
    "K = none": {"K": "none"},
}
BY_LT: Mapping[str, Mapping[str, Value]] = {
    f"LT = {lt}, strategy = {strategy}": {"LT": lt, "strategy": strategy}
    for lt in (1, 3)
    for strategy in ("strategy2", "none")
}


@dataclass(frozen=True)
class MadeRun:
    """What came of a run; episodes None: unfinished."""

    arm: str
    seed: int
    episodes: int | None
    fixed: float | None = 0.5
    """Share of fixed states at the end; None: a learner without states."""
    frozen: bool = True
    """Its frozen walk was completed."""

    @property
    def address(self) -> str:
        """Return where it lies."""
        return f"{self.arm}-{self.seed}".replace(" ", "")


def made_results(
    folder: Path,
    runs: Sequence[MadeRun],
    factors: Mapping[str, Mapping[str, Value]] = BY_K,
    **changes: Any,
) -> StudyResults:
    """Write the episodes of runs, and return the study's results."""
    told = {
        "title": "Made up", "paper": "Figure 2", "claim": "Fixed mode is faster.",
        "figure": "episodes", "baseline": "K = none" if factors is BY_K else None,
    }  # fmt: skip
    study = PlannedStudy(
        name="made",
        goal="schedule",
        most_episodes=BOUND,
        reduced=False,
        arms=tuple(
            PlannedArm(
                name, "by_settings", {}, {}, dict(values),
                {str(run.seed): run.address for run in runs if run.arm == name},
            )
            for name, values in factors.items()
        ),
        **(told | changes),
    )  # fmt: skip
    results = StudyResults(study, folder, pd.DataFrame([_row(run) for run in runs]))
    for run in runs:
        if run.episodes is not None:
            results.run_folder(run.address).mkdir(parents=True)
            path = results.run_folder(run.address) / EPISODES_FILE
            _episodes(run, run.episodes).to_parquet(path)
    return results


def _episodes(run: MadeRun, n: int) -> pd.DataFrame:
    walked = np.linspace(TICKS // 2, TICKS, n).astype(int)
    columns = {
        "episode": np.arange(1, n + 1),
        "control_ticks": walked,
        "target_ticks": np.full(n, TICKS),
        "end_cause": np.where(walked < TICKS, "zmp_error", "completed"),
    }
    if run.fixed is not None:
        columns |= {
            "basis_states": np.full(n, 50.0),
            "fixed_states": np.linspace(0.0, 50.0 * run.fixed, n),
            "penalty_states": np.zeros(n),
        }
    return pd.DataFrame(columns)


def _row(run: MadeRun) -> dict[str, Any]:
    row: dict[str, Any] = {
        "arm": run.arm, "seed": run.seed, "address": run.address,
        "state": "unfinished", "episodes": 7, "reached": False, "time": np.nan,
        "greedy": None,
        "simulated_s": np.nan, "evaluation_s": np.nan, "basis_states": np.nan,
        "fixed_states": np.nan, "penalty_states": np.nan, "computed_s": 1.0,
        "replayed_s": 0.0, "cpu_s": 1.0, "sittings": 1, "trajectory_sha256": "",
    }  # fmt: skip
    if run.episodes is None:
        return row
    table = _episodes(run, run.episodes)
    simulated_s = float(table["control_ticks"].sum() / 500)
    states = table.iloc[-1].reindex(["basis_states", "fixed_states"]).astype(float)
    return row | {
        "state": "finished", "episodes": run.episodes,
        "reached": run.episodes < BOUND, "time": float(run.episodes),
        "greedy": run.episodes if run.frozen and run.episodes < BOUND else None,
        "simulated_s": simulated_s, "evaluation_s": 3.0, "computed_s": simulated_s / 2,
        "trajectory_sha256": "ab" * 32, **states,
    }  # fmt: skip


def runs_of(
    arm: str, *episodes: int | None, fixed: float | None = 0.5
) -> list[MadeRun]:
    """Return the runs of an arm, seed by seed."""
    return [MadeRun(arm, seed, n, fixed) for seed, n in enumerate(episodes, 11)]


STRATEGY_1 = [
    *runs_of("K = 1", BOUND, BOUND, 30, 21, 34),
    *runs_of("K = 3", 9, 12, 8, 15, 10),
    *runs_of("K = none", 20, 26, BOUND, 31, 24, fixed=0.0),
]
"""5 runs of each of 3 arms, 3 of them stopped at the bound."""
