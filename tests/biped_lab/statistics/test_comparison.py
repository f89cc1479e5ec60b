"""One table of all arms: what is in it, and what does not change it."""

import numpy as np
import pandas as pd
import pytest

from biped_lab.statistics.censored import StatisticsError
from biped_lab.statistics.comparison import compare

BOUND = 1500
MEDIANS = {"K = 1": 800, "K = 15": 400, "none": 10_000}


def study(seeds=range(101, 111)):
    """Return runs: an arm that is slow, the baseline, and one that hardly arrives."""
    rng = np.random.default_rng(6)
    rows = []
    for arm, typical in MEDIANS.items():
        for seed in seeds:
            episodes = int(typical * np.exp(0.3 * rng.standard_normal()))
            rows.append(
                {
                    "arm": arm,
                    "seed": seed,
                    "state": "finished",
                    "reached": episodes <= BOUND,
                    "time": min(episodes, BOUND),
                }
            )
    return pd.DataFrame(rows)


def compared(runs, baseline="K = 15"):
    return compare(runs, baseline, BOUND, np.random.default_rng(1)).set_index("arm")


@pytest.fixture(scope="module")
def table():
    return compared(study())


def test_there_is_one_row_per_arm_in_the_order_of_the_runs(table):
    assert list(table.index) == list(MEDIANS)


def test_the_slow_arm_is_found_slow_by_every_figure(table):
    slow = table.loc["K = 1"]
    assert slow["ratio_low"] > 1.4
    assert slow["ratio_low"] < slow["ratio"] < slow["ratio_high"] < 4
    assert slow["improvement_high"] < 0.5
    assert slow["rmst_difference"] > 200
    tests = ["p_logrank", "p_rmst", "p_wilcoxon", "p_paired", "p_holm"]
    assert (slow[tests] < 0.02).all()


def test_an_arm_that_never_arrives_is_described_as_far_as_it_is_known(table):
    never = table.loc["none"]
    assert never["completed"] == 0
    assert never["median"] == never["ert"] == never["ratio_high"] == np.inf
    assert np.isnan(never["ratio"])
    assert never["ratio_low"] > 2


def test_p_values_are_corrected_for_both_comparisons(table):
    assert table.loc["K = 1", "p_holm"] >= 2 * table["p_wilcoxon"].min()


def test_the_baseline_is_not_compared_with_itself(table):
    own = table.loc["K = 15"]
    assert own["pairs"] == 0
    assert (
        own[["ratio", "ratio_low", "improvement", "p_wilcoxon", "p_holm"]].isna().all()
    )


def test_the_same_runs_give_the_same_table_to_the_last_bit(table):
    shuffled = study().sample(frac=1, random_state=3)
    shuffled["arm"] = pd.Categorical(shuffled["arm"], [*MEDIANS], ordered=True)
    shuffled = shuffled.sort_values("arm", kind="stable")
    assert compared(shuffled).to_csv() == table.to_csv()


def test_an_arm_s_row_does_not_depend_on_the_other_arms(table):
    runs = study()
    alone = compared(runs[runs["arm"] != "none"])
    columns = table.columns.drop("p_holm")
    pd.testing.assert_frame_equal(
        alone[columns], table.loc[["K = 1", "K = 15"], columns], check_exact=True
    )


def test_names_of_arms_do_not_matter(table):
    renamed = study().replace({"arm": {"K = 1": "slow", "K = 15": "fast"}})
    found = compared(renamed, "fast")
    assert (found.to_numpy() == table.to_numpy())[~table.isna().to_numpy()].all()


def test_unfinished_runs_are_counted_and_not_used(table):
    runs = study()
    waiting = runs.iloc[:3].assign(
        seed=[201, 202, 203], state="unfinished", time=np.nan, reached=None
    )
    found = compared(pd.concat([runs, waiting]))
    assert found.loc["K = 1", "unfinished"] == 3
    columns = table.columns.drop("unfinished")
    pd.testing.assert_frame_equal(found[columns], table[columns], check_exact=True)


def test_an_arm_without_results_has_a_row_without_figures():
    runs = study()
    runs.loc[runs["arm"] == "K = 1", "state"] = "unfinished"
    row = compared(runs).loc["K = 1"]
    assert (row["n"], row["unfinished"]) == (0, 10)
    assert row[["completed", "median", "ert", "ratio", "p_wilcoxon"]].isna().all()


def test_seeds_without_a_partner_stay_in_all_but_the_paired_test():
    runs = study()
    runs = runs[~((runs["arm"] == "K = 1") & (runs["seed"] > 107))]
    row = compared(runs).loc["K = 1"]
    assert (row["n"], row["pairs"]) == (7, 7)
    assert row["p_paired"] == 2 / 2**7


def test_arms_of_few_runs_get_figures_without_bootstrap_intervals():
    row = compared(study(range(4))).loc["K = 1"]
    assert row[["median", "ratio", "ert", "completed_high"]].notna().all()
    assert row[["median_low", "ratio_low", "ratio_high", "ert_high"]].isna().all()


def test_without_a_baseline_arms_are_described_only():
    table = compared(study(), None)
    assert table["median"].notna().all()
    assert table[["ratio", "p_wilcoxon", "p_holm"]].isna().all(axis=None)


# -- refusals ----------------------------------------------------------------------


def test_a_baseline_that_is_no_arm_is_refused():
    with pytest.raises(StatisticsError, match=r"baseline 'K = 2': no such arm.*K = 15"):
        compared(study(), "K = 2")


def test_a_seed_that_is_there_twice_is_refused():
    runs = study()
    with pytest.raises(StatisticsError, match="arm 'none': seed 110 is there twice"):
        compared(pd.concat([runs, runs.iloc[-1:]]))


def test_a_finished_run_without_a_time_is_refused():
    runs = study().astype({"time": float})
    runs.loc[0, "time"] = np.nan
    with pytest.raises(
        StatisticsError, match=r"arm 'K = 1': seed 101 .* without a time"
    ):
        compared(runs)
