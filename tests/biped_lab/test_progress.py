"""How far a study has come, in words."""

import math

import pytest

from biped_lab.progress import ArmProgress, left_s, summary


def arm(runs, cpu_s=(), running=0, spent_s=0.0):
    return ArmProgress(
        "K", len(cpu_s), running, runs, [math.inf] * runs, cpu_s, spent_s
    )


def test_nothing_is_known_of_the_time_left_before_a_run_is_done():
    assert left_s([arm(3, running=1, spent_s=50.0)]) is None
    assert (
        summary([arm(3)], 2) == "0 of 3 runs done, 0 running; time left: not known yet"
    )


def test_a_run_is_taken_to_need_what_the_median_of_its_arm_did():
    slow, fast = arm(4, (90.0, 110.0, 100.0)), arm(3, (10.0,))
    assert left_s([slow, fast]) == 100.0 + 2 * 10.0
    # An arm without a run that is done: as the median of all.
    assert left_s([slow, arm(2)]) == 100.0 + 2 * 100.0


def test_what_was_spent_already_is_not_left():
    assert left_s([arm(2, (100.0,), running=1, spent_s=30.0)]) == 70.0
    assert left_s([arm(2, (100.0,), running=1, spent_s=300.0)]) == 0.0


@pytest.mark.parametrize(
    ("workers", "left"),
    [
        (None, "about 20 min of processor time left"),
        (2, "about 10 min left"),
        (8, "about 5 min left"),  # no more workers than runs
    ],
)
def test_workers_share_the_time_that_is_left(workers, left):
    arms = [arm(5, (300.0,))]
    assert summary(arms, workers) == f"1 of 5 runs done, 0 running; {left}"


def test_a_study_that_is_done_has_nothing_left():
    assert summary([arm(1, (5.0,))], 2) == "1 of 1 runs done, 0 running; nothing left"
