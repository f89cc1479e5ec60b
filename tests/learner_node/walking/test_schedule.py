"""The learning schedule (Section 5.1)."""

import pytest

from learner_node.walking.schedule import LearningSchedule
from learner_node.walking.settings import ScheduleSettings

WALK_TICKS = 5625  # 11.25 s
TICK_S = 0.002


def schedule_of(walk_ticks=WALK_TICKS, **settings):
    return LearningSchedule(ScheduleSettings(**settings), walk_ticks)


def test_the_walk_has_eleven_subtasks():
    assert len(schedule_of().targets) == 11


def test_targets_are_a_step_and_half_steps_rounded_up_to_learning_ticks():
    targets = schedule_of().targets[:-1]
    for half_steps, target in enumerate(targets):
        exactly_s = 1.875 + 0.9375 * half_steps
        assert target % 10 == 0
        assert 0.0 <= target * TICK_S - exactly_s < 0.02


def test_the_first_targets_are_known_numbers():
    assert schedule_of().targets[:3] == (940, 1410, 1880)


def test_the_last_target_is_the_whole_walk():
    assert schedule_of().targets[-1] == WALK_TICKS


def test_a_target_on_a_learning_tick_is_not_rounded():
    targets = schedule_of(first_target_s=0.04, extension_s=0.02, walk_ticks=50).targets
    assert targets == (20, 30, 40, 50)


def test_a_walk_shorter_than_the_first_target_has_one_subtask():
    assert schedule_of(walk_ticks=500).targets == (500,)


def test_an_extension_too_short_to_count_is_refused():
    with pytest.raises(ValueError, match="extension_s"):
        schedule_of(extension_s=1e-7)


def test_a_first_target_too_short_to_count_is_refused():
    with pytest.raises(ValueError, match="first_target_s"):
        schedule_of(first_target_s=1e-7)


def test_learning_begins_with_the_first_target():
    assert schedule_of().target_ticks == 940


def test_fewer_than_lt_successes_leave_the_target_as_it_is():
    schedule = schedule_of(successes_per_subtask=3)
    assert [schedule.count_success() for _ in range(2)] == [False, False]
    assert schedule.target_ticks == 940


def test_lt_successes_extend_the_target():
    schedule = schedule_of(successes_per_subtask=3)
    assert [schedule.count_success() for _ in range(3)] == [False, False, True]
    assert schedule.target_ticks == 1410


def test_successes_count_anew_in_each_subtask():
    schedule = schedule_of(successes_per_subtask=2)
    targets = []
    for _ in range(6):
        schedule.count_success()
        targets.append(schedule.target_ticks)
    assert targets == [940, 1410, 1410, 1880, 1880, 2350]


def test_reaching_the_last_subtask_does_not_complete_the_schedule():
    schedule = schedule_of(successes_per_subtask=1)
    for _ in range(10):
        schedule.count_success()
    assert schedule.target_ticks == WALK_TICKS
    assert not schedule.complete


def completed_schedule():
    schedule = schedule_of(successes_per_subtask=2)
    for _ in range(2 * 11):
        finished = schedule.count_success()
    assert finished
    return schedule


def test_finishing_the_last_subtask_completes_the_schedule():
    assert completed_schedule().complete


def test_beyond_the_last_subtask_the_target_stays_the_whole_walk():
    schedule = completed_schedule()
    for _ in range(20):
        schedule.count_success()
    assert schedule.target_ticks == WALK_TICKS
    assert schedule.complete
