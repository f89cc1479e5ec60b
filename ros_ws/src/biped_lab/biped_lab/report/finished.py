"""The finished runs of a study, as the figures and tables see them.

Until the goal: episodes, and simulated seconds of these episodes (the paper's "total
learning time"). A run that did not reach its goal counts with the bound at which it was
stopped, so that a mean is the mean restricted to the bound.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from biped_lab.report.arrangement import Arrangement, arrange
from biped_lab.results import StudyResults
from biped_lab.statistics.censored import CensoredTimes

FIXED_SHARE = "fixed_share"
EPISODES, SIMULATED = "time", "simulated_s"
"""A run ends with its goal, or at the bound."""


@dataclass(frozen=True)
class FinishedRuns:
    """Runs that have ended, and the episodes of each."""

    results: StudyResults
    arrangement: Arrangement
    runs: pd.DataFrame
    """As `StudyResults.runs`, and the FIXED_SHARE of the states at the end."""
    tables: dict[str, pd.DataFrame]
    """Episodes by the run's address."""
    arms: tuple[str, ...]
    """Those with a finished run, in the study's order."""

    def of(self, arm: str) -> pd.DataFrame:
        """Return the runs of an arm."""
        return self.runs[self.runs["arm"] == arm]

    def values(self, arm: str, column: str) -> NDArray[np.float64]:
        """Return (runs,) what the runs of an arm have in a column; NaN left out."""
        return np.asarray(self.of(arm)[column].dropna(), dtype=np.float64)

    def times(self, arm: str) -> CensoredTimes:
        """Return the episodes until each run of an arm was at the goal."""
        runs = self.of(arm)
        return CensoredTimes(
            runs[EPISODES].to_numpy(dtype=np.float64), runs["reached"].to_numpy(bool)
        )

    def tables_of(self, arm: str) -> list[pd.DataFrame]:
        """Return the episodes of each run of an arm."""
        return [self.tables[address] for address in self.of(arm)["address"]]

    @property
    def tries_frozen_walks(self) -> bool:
        """Whether a frozen walk, tried once at a run's end, is not the goal itself."""
        return self.results.study.goal == "schedule"

    def frozen_walks(self, arm: str) -> tuple[int, int]:
        """Return how many frozen walks were completed, of the runs at the goal."""
        runs = self.of(arm)
        at_goal = runs[runs["reached"]]
        return int(at_goal["greedy"].notna().sum()), len(at_goal)

    @property
    def fixing_arms(self) -> tuple[str, ...]:
        """Arms in which a state was ever fixed."""
        return tuple(
            arm
            for arm in self.arms
            if any(
                "fixed_states" in table and (table["fixed_states"] > 0).any()
                for table in self.tables_of(arm)
            )
        )

    @property
    def rivals(self) -> set[str]:
        """Arms that others are compared with."""
        rivals = {self.arrangement.rivals[arm] for arm in self.arms}
        return {arm for arm in self.arms if arm in rivals}

    @property
    def bound(self) -> int:
        """Episodes after which a run is stopped."""
        return self.results.study.most_episodes


def finished_runs(results: StudyResults) -> FinishedRuns:
    """Read the episodes of all finished runs."""
    runs = results.runs[results.runs["state"] == "finished"].copy()
    tables = {address: results.episodes(address) for address in runs["address"]}
    runs[FIXED_SHARE] = runs["fixed_states"] / runs["basis_states"]
    found = set(runs["arm"])
    arms = tuple(arm.name for arm in results.study.arms if arm.name in found)
    return FinishedRuns(results, arrange(results.study), runs, tables, arms)
