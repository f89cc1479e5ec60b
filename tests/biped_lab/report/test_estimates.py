from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.biped_lab.report.made_results import BOUND, STRATEGY_1, made_results, runs_of

from biped_lab.report.estimates import compared, ratio_of_means, restricted_mean
from biped_lab.report.finished import EPISODES, FinishedRuns, finished_runs

N = 6
TIMES = st.lists(st.integers(2, BOUND), min_size=N, max_size=N)


def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def finished(folder: Path, arm: list[int], baseline: list[int]) -> FinishedRuns:
    runs = [*runs_of("K = 3", *arm), *runs_of("K = none", *baseline)]
    return finished_runs(made_results(folder, runs))


@pytest.fixture(scope="module")
def any_runs(tmp_path_factory: pytest.TempPathFactory) -> FinishedRuns:
    return finished(tmp_path_factory.mktemp("lab"), [9] * N, [9] * N)


def taking(runs: FinishedRuns, times: list[int]) -> FinishedRuns:
    """Return runs of both arms that took these numbers of episodes."""
    return replace(runs, runs=runs.runs.assign(time=[float(t) for t in times]))


@settings(max_examples=25, deadline=None)
@given(TIMES)
def test_a_mean_lies_in_its_interval_and_that_between_the_runs(
    any_runs: FinishedRuns, times: list[int]
) -> None:
    runs = taking(any_runs, [*times, *[9] * N])
    mean = restricted_mean(runs, "K = 3", EPISODES, rng())
    assert mean.value == np.mean(times)
    rounding = 1e-9
    assert min(times) - rounding <= mean.low <= mean.value + rounding
    assert mean.value - rounding <= mean.high <= max(times) + rounding


@settings(max_examples=25, deadline=None)
@given(TIMES)
def test_an_arm_like_its_rival_seed_by_seed_has_the_ratio_one_for_certain(
    any_runs: FinishedRuns, times: list[int]
) -> None:
    runs = taking(any_runs, [*times, *times])
    assert ratio_of_means(runs, "K = 3", EPISODES, rng()) == (1.0, 1.0, 1.0)


def test_few_runs_have_a_mean_but_no_interval(tmp_path: Path) -> None:
    mean = restricted_mean(finished(tmp_path, [4, 6], [9, 9]), "K = 3", EPISODES, rng())
    assert mean.value == 5.0
    assert np.isnan([mean.low, mean.high]).all()


def test_the_baseline_has_no_ratio(tmp_path: Path) -> None:
    ratio = ratio_of_means(
        finished(tmp_path, [4, 6], [9, 9]), "K = none", EPISODES, rng()
    )
    assert np.isnan(ratio).all()


def test_p_values_are_corrected_for_all_comparisons(tmp_path: Path) -> None:
    table = compared(finished_runs(made_results(tmp_path, STRATEGY_1)), rng())
    tested = table["p_wilcoxon"].dropna()
    assert len(tested) == 2
    assert table["p_holm"].dropna().min() == 2 * tested.min()
