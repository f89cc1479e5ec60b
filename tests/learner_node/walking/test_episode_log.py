"""The log of a run: a row per episode, in a checkpoint and as CSV."""

import csv
import io
import math

import numpy as np
import pytest
from msgspec.structs import replace
from tests.payloads import RESULT

from learner_node.walking.episode_log import EpisodeLog
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import CostTerms, EpisodeResult

COST = CostTerms(
    zmp=0.5,
    final_zmp=0.25,
    joint_tracking=0.0,
    joint_torque=0.125,
    final_joint_position=0.0,
    final_joint_velocity=0.0,
)


def result(
    control_ticks: int = 940,
    target_ticks: int = 940,
    end_cause: EndCause = EndCause.COMPLETED,
    cost: CostTerms | None = COST,
    reward: float = 10_000.0,
) -> EpisodeResult:
    return replace(
        RESULT,
        episode=1,
        end_cause=end_cause,
        control_ticks=control_ticks,
        target_ticks=target_ticks,
        cost=cost,
        t_err_estimate=None,
        reward=reward,
    )


def log_of(*results: EpisodeResult) -> EpisodeLog:
    log = EpisodeLog()
    for each in results:
        log.append(each)
    return log


def rows(log: EpisodeLog) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(log.csv_text())))


# -- CSV ---------------------------------------------------------------------------


def test_a_row_tells_an_episode_in_seconds_and_words():
    assert rows(log_of(result())) == [
        {
            "episode": "1",
            "walked_s": "1.880",
            "target_s": "1.880",
            "end_cause": "completed",
            "reward": "10000.0",
            "t_err": "0.875",
            "peak_zmp_error_m": "0.03",
        }
    ]


def test_an_empty_log_is_a_header():
    assert EpisodeLog().csv_text() == (
        "episode,walked_s,target_s,end_cause,reward,t_err,peak_zmp_error_m\n"
    )


def test_episodes_are_numbered_from_one():
    log = log_of(*[result()] * 3)
    assert [row["episode"] for row in rows(log)] == ["1", "2", "3"]


@pytest.mark.parametrize("cause", list(EndCause))
def test_every_end_cause_is_written_as_its_word(cause):
    assert rows(log_of(result(end_cause=cause)))[0]["end_cause"] == cause.value


def test_a_walk_without_a_cost_has_no_number_there():
    assert math.isnan(float(rows(log_of(result(cost=None)))[0]["t_err"]))


def test_numbers_are_written_to_their_last_bit():
    log = log_of(result(reward=0.1 + 0.2))
    assert float(rows(log)[0]["reward"]) == 0.1 + 0.2


# -- survival ----------------------------------------------------------------------


def test_survival_is_the_share_of_the_target_that_was_walked():
    log = log_of(result(940, 940), result(470, 940))
    assert log.survival() == pytest.approx(0.75)


def test_survival_looks_at_the_last_episodes_only():
    log = log_of(result(0, 940), result(940, 940), result(940, 940))
    assert log.survival(last=2) == 1.0


def test_nobody_has_survived_before_the_first_episode():
    assert EpisodeLog().survival() == 0.0


# -- arrays ------------------------------------------------------------------------


def test_a_log_comes_back_from_its_arrays():
    log = log_of(
        result(),
        result(12, 940, EndCause.ZMP_ERROR),
        result(end_cause=EndCause.PHYSICS_NAN),
    )
    assert EpisodeLog(log.arrays()).csv_text() == log.csv_text()


def test_an_empty_log_comes_back_from_its_arrays():
    assert len(EpisodeLog(EpisodeLog().arrays())) == 0


def test_a_log_that_came_back_grows_on():
    log = EpisodeLog(log_of(result()).arrays())
    log.append(result(12))
    assert log.csv_text() == log_of(result(), result(12)).csv_text()


def test_the_arrays_are_numbers_of_equal_length():
    arrays = log_of(result(), result(cost=None)).arrays()
    assert {(array.dtype.kind in "if", array.shape) for array in arrays.values()} == {
        (True, (2,))
    }


def test_a_log_without_a_column_is_refused():
    arrays = log_of(result()).arrays()
    del arrays["reward"]
    with pytest.raises(ValueError, match="columns"):
        EpisodeLog(arrays)


def test_a_log_with_a_column_too_many_is_refused():
    arrays = log_of(result()).arrays() | {"mood": np.zeros(1)}
    with pytest.raises(ValueError, match=r"columns .*mood"):
        EpisodeLog(arrays)


def test_a_log_with_columns_of_different_length_is_refused():
    arrays = log_of(result()).arrays() | {"reward": np.zeros(2)}
    with pytest.raises(ValueError, match="different length"):
        EpisodeLog(arrays)
