"""A learner led through the task of walking, by observations made by hand."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation, ticks_until
from tests.learner_node.walking.small_settings import SETTINGS

from learner_node.walking.settings import (
    ActionSettings,
    RewardSettings,
)
from learner_node.walking.task import WalkTask
from learner_node.walking.walks import LearningWalk
from learner_node.xol.agent import XolAgent
from learner_node.xol.settings import FixedModeSettings
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult

# Three subtasks of 3, 5 and 6.2 learning ticks.
WALK_TICKS = 62
TARGETS = (30, 50, 62)


class Lesson:
    """XoL, the task, and the walk that joins them."""

    def __init__(self, settings):
        self.task = WalkTask(settings, WALK_TICKS)
        self.agent = XolAgent(
            settings.xol, settings.states, self.task.problem, np.random.default_rng(0)
        )
        self.respond = LearningWalk(self.task, self.agent).respond


def new_learner(**sections):
    return Lesson(replace(SETTINGS, **sections))


def walk(learner, end=None, cause=None, t_err=0.0):
    """Walk to the control tick `end` (the target) through states that differ.

    Returns:
        (answers before the end, the answer to the last observation).
    """
    end = learner.task.schedule.target_ticks if end is None else end
    answers = []
    for tick in ticks_until(end):
        last = tick == end
        answers.append(
            learner.respond(
                observation(
                    tick,
                    waist_in_support_foot_m=(float(tick), 0.0),
                    # 10 times the mean joint error is a term of T_err.
                    mean_joint_error_rad=t_err / 10.0 if last else 0.0,
                    end_cause=cause if last else None,
                )
            )
        )
    return answers[:-1], answers[-1]


def result_of(learner, **walk_changes):
    return walk(learner, **walk_changes)[1]


def rewards_counted(learner):
    """TUC of all states."""
    agent = learner.agent
    return agent.rules.rewards[: agent.states.count].tolist()


# -- corrections ----------------------------------------------------------------------


def test_the_schedule_of_these_tests():
    assert new_learner().task.schedule.targets == TARGETS


def test_every_observation_before_the_end_is_answered_with_a_correction():
    answers, _ = walk(new_learner())
    assert [answer.shape for answer in answers] == [(2,)] * 3


def test_corrections_are_among_the_alternatives():
    learner = new_learner()
    learner.task.schedule.subtask = 2
    answers, _ = walk(learner)
    steps = np.array(answers) / 0.012
    assert np.abs(steps).max() <= 2.0
    np.testing.assert_allclose(steps, np.rint(steps), atol=1e-12)


def test_all_alternatives_are_tried():
    learner = new_learner()
    seen = {value for _ in range(50) for answer in walk(learner)[0] for value in answer}
    np.testing.assert_allclose(sorted(seen), [-0.024, -0.012, 0, 0.012, 0.024])


def test_a_decision_is_held_for_the_set_number_of_ticks():
    learner = new_learner(action=ActionSettings(alternatives=1001, hold_ticks=3))
    learner.task.schedule.subtask = 2
    answers, _ = walk(learner)  # at ticks 0, 10, ..., 60
    changes = [not np.array_equal(a, b) for a, b in pairwise(answers)]
    assert changes == [False, False, True, False, False, True]


def test_only_ticks_of_decision_make_states():
    learner = new_learner(action=ActionSettings(hold_ticks=3))
    learner.task.schedule.subtask = 2
    walk(learner)
    assert learner.agent.states.count == 3


def test_learning_is_the_same_for_the_same_seed():
    first, second = new_learner(), new_learner()
    for _ in range(10):
        result_of(first, end=20, cause=EndCause.ZMP_ERROR)
        result_of(second, end=20, cause=EndCause.ZMP_ERROR)
        assert np.array_equal(walk(first)[0], walk(second)[0])


# -- rewards (Table 2) ----------------------------------------------------------------


def test_reaching_the_target_time_ends_the_walk():
    result = result_of(new_learner())
    assert isinstance(result, EpisodeResult)
    assert result.completed
    assert (result.control_ticks, result.target_ticks) == (30, 30)


def test_the_first_walk_that_reaches_the_target_time_is_a_success():
    result = result_of(new_learner(), t_err=1e6)
    assert result.reward == 10_000.0
    assert result.t_err_estimate is None


def test_a_later_walk_below_the_estimate_is_a_success():
    learner = new_learner()
    result_of(learner, t_err=2.0)
    result = result_of(learner, t_err=2.05)
    assert result.t_err_estimate == pytest.approx(2.1)
    assert result.reward == 10_000.0


def test_a_later_walk_above_the_estimate_only_reaches_the_goal():
    learner = new_learner()
    result_of(learner, t_err=2.0)
    assert result_of(learner, t_err=2.2).reward == 10.0


def test_a_walk_is_compared_before_it_changes_the_estimate():
    learner = new_learner()
    for t_err in (2.0, 3.0):
        result_of(learner, t_err=t_err)
    assert result_of(learner, t_err=3.0).t_err_estimate == pytest.approx(2.19)


def test_the_reward_reinforces_the_decisions_by_their_eligibility():
    learner = new_learner()
    walk(learner)
    strongest = learner.agent.rules.q[:3].max(axis=2)
    assert strongest.tolist() == [[2500.0] * 2, [5000.0] * 2, [10_000.0] * 2]


def test_rewards_are_those_of_the_settings():
    learner = new_learner(rewards=RewardSettings(success=7.0, goal=3.0))
    rewards = [result_of(learner, t_err=t_err).reward for t_err in (2.0, 9.0)]
    assert rewards == [7.0, 3.0]


def test_a_success_counts_in_the_states_on_the_way():
    learner = new_learner()
    result_of(learner, t_err=2.0)
    assert rewards_counted(learner) == [1, 1, 1]


def test_merely_reaching_the_goal_does_not_count():
    learner = new_learner()
    result_of(learner, t_err=2.0)
    result_of(learner, t_err=2.2)
    assert rewards_counted(learner) == [1, 1, 1]


def test_the_result_reports_the_cost():
    assert result_of(new_learner(), t_err=2.5).cost.total == pytest.approx(2.5)


def test_the_cost_of_a_walk_does_not_reach_into_the_next():
    learner = new_learner()
    for tick in ticks_until(30):
        learner.respond(observation(tick, torque_integral_n2m2_s=1e6))
    assert result_of(learner).cost.total == 0.0


# -- schedule -------------------------------------------------------------------------


def test_successes_extend_the_target_time():
    learner = new_learner()
    targets = [result_of(learner, t_err=2.0).target_ticks for _ in range(8)]
    assert targets == [30, 30, 50, 50, 62, 62, 62, 62]


def test_merely_reaching_the_goal_does_not_extend_the_target_time():
    learner = new_learner()
    costs = (2.0, *[3.0] * 5)
    targets = [result_of(learner, t_err=t_err).target_ticks for t_err in costs]
    assert targets == [30] * 6


def test_failures_do_not_extend_the_target_time():
    learner = new_learner()
    for _ in range(5):
        result_of(learner, end=20, cause=EndCause.ZMP_ERROR)
    assert learner.task.schedule.target_ticks == 30


def test_each_subtask_begins_without_an_estimate():
    learner = new_learner()
    for _ in range(2):
        result_of(learner, t_err=2.0)
    result = result_of(learner, t_err=50.0)
    assert result.t_err_estimate is None
    assert result.reward == 10_000.0


def test_the_result_says_when_the_schedule_is_complete():
    learner = new_learner()
    complete = [result_of(learner, t_err=2.0).schedule_complete for _ in range(7)]
    assert complete == [False] * 5 + [True] * 2


def test_after_the_last_subtask_the_estimate_stays():
    learner = new_learner()
    for _ in range(6):
        result_of(learner, t_err=2.0)
    assert result_of(learner, t_err=9.0).reward == 10.0


def test_the_result_says_in_which_subtask_it_was_walked():
    learner = new_learner()
    subtasks = [result_of(learner, t_err=2.0).subtask for _ in range(7)]
    assert subtasks == [0, 0, 1, 1, 2, 2, 2]


def fixed_after_the_first_subtask(strategy):
    fixed_mode = FixedModeSettings(strategy=strategy)
    learner = new_learner(xol=replace(SETTINGS.xol, fixed_mode=fixed_mode))
    fixed = []
    for _ in range(2):
        result_of(learner, t_err=2.0)
        fixed.append(learner.agent.figures()["fixed_states"])
    return fixed


def test_strategy_2_fixes_states_when_a_subtask_is_finished():
    assert fixed_after_the_first_subtask("strategy2") == [0, 3]


def test_without_fixed_mode_a_finished_subtask_fixes_nothing():
    assert fixed_after_the_first_subtask("none") == [0, 0]


# -- failures -------------------------------------------------------------------------

PENALTIES = {
    EndCause.ZMP_ERROR: 0,
    EndCause.JOINT_VELOCITY: 1,
    EndCause.IK_UNREACHABLE: 0,
    EndCause.IK_JOINT_LIMIT: 0,
    EndCause.TORQUE_SATURATION: 0,
    EndCause.FEET_UNLOADED: 0,
    EndCause.TILT: 0,
}
PHYSICS_FAULTS = (EndCause.FOOT_THROUGH_FLOOR, EndCause.PHYSICS_NAN)
FROM_OUTSIDE = (
    EndCause.LATE,
    EndCause.PEER_SILENT,
    EndCause.RESET,
    EndCause.DISTURBED,
    EndCause.SENSORS_SILENT,
    EndCause.SENSORS_INVALID,
    EndCause.EMERGENCY_STOP,
    EndCause.NOT_STANDING,
    EndCause.NOT_FOLLOWING,
)
BLAMELESS = (*PHYSICS_FAULTS, *FROM_OUTSIDE)


def test_every_end_of_a_walk_is_considered_here():
    assert {*PENALTIES, *BLAMELESS, EndCause.COMPLETED} == set(EndCause)


def penalties_paid(learner):
    """Sum of P per type of penalty."""
    return learner.agent.rules.p.sum(axis=(0, 2, 3)).tolist()


@pytest.mark.parametrize("cause, penalty", PENALTIES.items())
def test_a_failure_pays_its_penalty_on_the_last_three_decisions(cause, penalty):
    learner = new_learner()
    walk(learner, end=29, cause=cause)
    components, pnlty = 2, 10.0
    expected = [0.0, 0.0, 0.0]
    expected[penalty] = components * pnlty * (1 + 0.5 + 0.25)
    assert penalties_paid(learner) == expected


@pytest.mark.parametrize("cause", PENALTIES)
def test_a_failure_counts_against_the_decisions_that_it_is_credited_to(cause):
    learner = new_learner()
    walk(learner, end=29, cause=cause)
    failures = learner.agent.rules.failures[:3, PENALTIES[cause]]
    assert failures.sum(axis=(1, 2)).tolist() == [0, 2, 2]


@pytest.mark.parametrize("cause", BLAMELESS)
def test_an_end_that_is_not_the_learners_fault_pays_no_penalty(cause):
    learner = new_learner()
    walk(learner, end=29, cause=cause)
    assert penalties_paid(learner) == [0.0, 0.0, 0.0]
    assert not learner.agent.rules.failures.any()


@pytest.mark.parametrize("cause", [*PENALTIES, *BLAMELESS])
def test_a_walk_that_fails_gets_no_reward(cause):
    learner = new_learner()
    result = result_of(learner, end=29, cause=cause)
    assert (result.end_cause, result.reward) == (cause, 0.0)
    assert not learner.agent.rules.q.any()


def test_a_failure_at_the_target_time_is_a_failure():
    result = result_of(new_learner(), end=30, cause=EndCause.ZMP_ERROR)
    assert result.end_cause is EndCause.ZMP_ERROR


def test_a_failure_leaves_the_estimate_alone():
    learner = new_learner()
    result_of(learner, t_err=2.0)
    result_of(learner, end=20, cause=EndCause.ZMP_ERROR, t_err=0.1)
    assert result_of(learner, t_err=2.0).t_err_estimate == pytest.approx(2.1)


def test_the_penalty_is_that_of_the_settings():
    learner = new_learner(rewards=RewardSettings(penalty=1.0))
    walk(learner, end=29, cause=EndCause.ZMP_ERROR)
    assert sum(penalties_paid(learner)) == 2 * 1.0 * (1 + 0.5 + 0.25)


def test_a_walk_that_fails_before_it_begins_has_no_cost():
    result = result_of(new_learner(), end=0, cause=EndCause.IK_UNREACHABLE)
    assert result.cost is None


def test_a_walk_that_fails_before_it_begins_teaches_nothing():
    learner = new_learner()
    walk(learner)
    rules = learner.agent.rules
    before = {name: getattr(rules, name).copy() for name in rules.ARRAYS}
    walk(learner, end=0, cause=EndCause.IK_UNREACHABLE)
    changed = [
        name
        for name in before
        if not np.array_equal(getattr(rules, name), before[name])
    ]
    assert changed == []


def test_a_walk_broken_off_is_not_learned_from():
    learner = new_learner()
    learner.respond(observation(0, waist_in_support_foot_m=(500.0, 0.0)))
    walk(learner)
    assert learner.agent.rules.rewards[0] == 0
