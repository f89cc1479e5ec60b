"""Walks that go on to the next target once they have mastered one."""

from dataclasses import replace

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation, ticks_until
from tests.learner_node.walking.sessions import WALK_TICKS, state_of
from tests.learner_node.walking.small_settings import SETTINGS

from learner_node.walking.session import LearningSession
from learner_node.walking.settings import BlameSettings
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult

REWARD = 10_000.0
RUN_ON = replace(
    SETTINGS,
    schedule=replace(
        SETTINGS.schedule,
        successes_per_subtask=1,
        first_target_s=0.06,
        extension_s=0.02,
        run_on=True,
        proof_s=0.04,
    ),
    xol=replace(
        SETTINGS.xol,
        fixed_mode=replace(SETTINGS.xol.fixed_mode, strategy="strategy2"),
    ),
)


def session_of(settings=RUN_ON):
    return LearningSession(settings, WALK_TICKS, seed=0)


def walk(session, until=WALK_TICKS, cause=None, **last):
    """Walk through states that differ; return the answer to the last observation."""
    for tick in ticks_until(until):
        changes = {"end_cause": cause, **last} if tick == until else {}
        answer = session.respond(
            observation(
                tick,
                waist_in_support_foot_m=(float(tick), 0.0),
                mean_joint_error_rad=0.1,  # so that T_err is not nought
                **changes,
            )
        )
        if isinstance(answer, EpisodeResult):
            return answer
    return answer


def test_one_walk_can_pass_all_targets():
    session = session_of()
    result = walk(session)
    assert (result.control_ticks, result.completed) == (WALK_TICKS, True)
    assert session.task.schedule.targets == (30, 40, 50)
    assert session.task.schedule.complete
    assert result.reward == 3 * REWARD


def test_without_it_a_walk_ends_at_its_target():
    ends = replace(RUN_ON, schedule=replace(RUN_ON.schedule, run_on=False))
    assert walk(session_of(ends)).control_ticks == 30


def test_a_walk_goes_on_only_from_a_subtask_that_it_has_mastered():
    twice = replace(RUN_ON.schedule, successes_per_subtask=2)
    session = session_of(replace(RUN_ON, schedule=twice))
    assert walk(session).control_ticks == 30
    assert walk(session).control_ticks == 40


def test_what_a_walk_has_passed_stays_passed_when_it_fails():
    session = session_of()
    result = walk(session, until=45, cause=EndCause.ZMP_ERROR)
    assert (result.end_cause, result.reward) == (EndCause.ZMP_ERROR, 2 * REWARD)
    assert session.task.schedule.target_ticks == 50


def test_a_target_is_passed_once():
    session = session_of()
    walk(session, until=45, cause=EndCause.ZMP_ERROR)
    assert walk(session, until=45, cause=EndCause.ZMP_ERROR).reward == 0.0


def test_the_last_decisions_before_a_target_are_not_rewarded():
    session = session_of()
    walk(session, until=35, cause=EndCause.JOINT_VELOCITY)
    rules = session.learner.rules
    # Decisions at 0, 10 and 20; two of them within the last 0.04 s before tick 30.
    assert rules.rewards[:3].tolist() == [1, 0, 0]
    assert rules.fixed[:3].tolist() == [True, False, False]
    assert rules.q[0].any() and not rules.q[1:3].any()


def test_at_the_end_of_the_walk_all_are():
    session = session_of()
    walk(session)
    assert (session.learner.rules.rewards[:5] > 0).all()


@pytest.mark.parametrize("method", ["xol", "q_lambda"])
@pytest.mark.parametrize("before", [0, 1])
def test_a_walk_that_is_given_up_has_passed_nothing(method, before):
    session = session_of(replace(RUN_ON, method=method))
    for _ in range(before):
        walk(session, until=35, cause=EndCause.ZMP_ERROR)
    kept = state_of(session)
    walk(session, until=48, cause=EndCause.LATE)
    assert session.tally.given_up == {EndCause.LATE: 1}
    session.tally.given_up.clear()
    assert state_of(session) == kept


# -- what a failure tells ------------------------------------------------------------


def told_push(session, **last):
    """What the learner is told of a failure."""
    heard = []
    learner = session.learner
    session.learner.penalise = lambda penalty, push: heard.append(push)
    walk(session, until=25, **last)
    del learner.penalise
    return heard[0]


def directed(**blame):
    return session_of(replace(RUN_ON, blame=BlameSettings(directed=True, **blame)))


def test_the_push_is_along_the_zmp_error():
    push = told_push(directed(), cause=EndCause.ZMP_ERROR, zmp_error_m=(0.0, -0.065))
    assert push.shape == (60, 2)
    assert not push[:, 0].any()
    # What moves the ZMP to +y works against an error along -y.
    assert push[0, 1] > 0.0 > push[30, 1]


@pytest.mark.parametrize("cause", [EndCause.JOINT_VELOCITY, EndCause.FEET_UNLOADED])
def test_other_failures_have_no_direction(cause):
    assert told_push(directed(), cause=cause, zmp_error_m=(0.0, 0.01)) is None


def test_an_error_of_nought_has_none_either():
    assert told_push(directed(), cause=EndCause.ZMP_ERROR) is None


def test_as_in_the_paper_nothing_is_known_of_the_push():
    push = told_push(session_of(), cause=EndCause.ZMP_ERROR, zmp_error_m=(0.0, -0.065))
    assert push is None


def test_one_alternative_more_pushes_by_its_step():
    fine = replace(RUN_ON.action, alternatives=2 * RUN_ON.action.alternatives - 1)
    blame = BlameSettings(directed=True)
    pushes = [
        told_push(
            session_of(replace(RUN_ON, action=action, blame=blame)),
            cause=EndCause.ZMP_ERROR,
            zmp_error_m=(0.03, 0.04),
        )
        for action in (RUN_ON.action, fine)
    ]
    np.testing.assert_allclose(pushes[0], 2.0 * pushes[1])
