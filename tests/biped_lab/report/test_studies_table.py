"""Two studies, arm by arm."""

from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest
from tests.biped_lab.report.made_results import STRATEGY_1, made_results, runs_of

from biped_lab.markdown import Table
from biped_lab.report.tables import studies_table
from biped_lab.results import ResultsError, StudyResults


def results(folder: Path, slower: int = 1) -> StudyResults:
    """Return Figure 2's made-up runs, all so many times slower."""
    made = made_results(folder, STRATEGY_1)
    made.runs["time"] *= slower
    return made


def table(one: StudyResults, other: StudyResults) -> Table:
    return studies_table(one, other, np.random.default_rng(0))


def test_a_study_does_not_differ_from_itself(tmp_path: Path) -> None:
    study = results(tmp_path)
    rows = table(study, study).rows
    assert [row[0] for row in rows] == ["K = 1", "K = 3", "K = none"]
    assert all(row[1] == row[2] for row in rows)
    assert {row[3].partition(" ")[0] for row in rows} == {"1.00"}
    assert {row[5] for row in rows} == {"1"}


def test_the_ratio_is_of_the_first_to_the_second(tmp_path: Path) -> None:
    fast, slow = results(tmp_path / "fast"), results(tmp_path / "slow", slower=3)
    assert {row[3].partition(" ")[0] for row in table(fast, slow).rows} == {"0.33"}
    assert {row[3].partition(" ")[0] for row in table(slow, fast).rows} == {"3.00"}


def test_only_arms_of_both_studies_are_compared(tmp_path: Path) -> None:
    whole = results(tmp_path / "whole")
    part = made_results(
        tmp_path / "part", runs_of("K = 3", 5, 6, 7), {"K = 3": {}}, baseline=None
    )
    assert [row[0] for row in table(whole, part).rows] == ["K = 3"]


def test_studies_without_a_common_arm_are_refused(tmp_path: Path) -> None:
    other = made_results(
        tmp_path / "other", runs_of("A", 5, 6), {"A": {}}, baseline=None
    )
    with pytest.raises(ResultsError, match="no arm in common"):
        table(results(tmp_path / "one"), other)


def test_other_bounds_are_refused(tmp_path: Path) -> None:
    study = results(tmp_path)
    longer = msgspec.structs.replace(study.study, most_episodes=41)
    with pytest.raises(ResultsError, match="bounds of 40 and 41 episodes"):
        table(study, replace(study, study=longer))


def test_other_goals_are_refused(tmp_path: Path) -> None:
    study = results(tmp_path)
    greedy = msgspec.structs.replace(study.study, goal="greedy")
    with pytest.raises(ResultsError, match="the goals schedule and greedy do not"):
        table(study, replace(study, study=greedy))
