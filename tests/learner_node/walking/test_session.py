"""Learning and frozen trials, walk after walk, fed with observations made by hand."""

import json
from dataclasses import replace

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation, ticks_until

from learner_node.walking.session import LearningSession
from learner_node.walking.settings import (
    ActionSettings,
    LearnerSettings,
    ScheduleSettings,
)
from learner_node.xol.settings import XolSettings
from msgs_json.end_cause import EndCause
from msgs_json.episode_result import EpisodeResult
from msgs_json.learner_status import LearnerStatus
from msgs_json.wire import decode, encode

# Two subtasks of 3 and 5 learning ticks.
WALK_TICKS = 50
SETTINGS = LearnerSettings(
    xol=XolSettings(
        discount=0.5,
        queue_length=20,
        failure_reach=2,
        minimum_selections=1000,
        selection_memory=0,
    ),
    action=ActionSettings(alternatives=5),
    schedule=ScheduleSettings(
        successes_per_subtask=2, first_target_s=0.06, extension_s=0.04
    ),
)
SCHEDULE_EPISODES = 4
FALL = {"end": 20, "cause": EndCause.ZMP_ERROR}


def new_session(seed=0):
    return LearningSession(SETTINGS, WALK_TICKS, seed)


def begin(session, sha=""):
    return session.respond(observation(0, trajectory_sha256=sha))


def walk(session, end=WALK_TICKS, cause=None, t_err=2.0, sha="walked"):
    """Walk until there is a result, at `end` at the latest; return all answers."""
    answers = []
    for tick in ticks_until(end):
        answers.append(
            session.respond(
                observation(
                    tick,
                    waist_in_support_foot_m=(float(tick), 0.0),
                    # 10 times the mean joint error is a term of T_err.
                    mean_joint_error_rad=t_err / 10.0,
                    trajectory_sha256=sha,
                    end_cause=cause if tick == end else None,
                )
            )
        )
        if isinstance(answers[-1], EpisodeResult):
            return answers
    raise AssertionError("no result at the end of the walk")


def result_of(session, **changes):
    return walk(session, **changes)[-1]


def state_of(session):
    """All that a checkpoint holds, to compare."""
    arrays = {name: a.tolist() for name, a in session.arrays().items()}
    return json.dumps([session.header(), arrays])


def with_schedule_complete():
    session = new_session()
    for _ in range(SCHEDULE_EPISODES):
        result_of(session)
    return session


def learned_session():
    session = with_schedule_complete()
    result_of(session)
    return session


def copy_of(session):
    """A session restored from what a checkpoint keeps of another."""
    copy = new_session(seed=9)
    header = json.loads(json.dumps(session.header()))
    copy.restore(header, {k: v.copy() for k, v in session.arrays().items()})
    return copy


# -- answers ---------------------------------------------------------------------------


def test_every_observation_before_the_end_is_answered_with_a_correction():
    answers = walk(new_session(), end=30)
    assert [answer.shape for answer in answers[:-1]] == [(2,)] * 3


def test_a_session_walks_from_the_first_observation_to_the_result():
    session = new_session()
    found = [session.walking]
    begin(session)
    found.append(session.walking)
    result_of(session)
    assert [*found, session.walking] == [False, True, False]


def test_a_learning_episode_says_that_it_is_one():
    assert result_of(new_session()).learning


def test_the_same_seed_gives_the_same_session():
    one, other = new_session(), new_session()
    for session in (one, other):
        for changes in (FALL, {}, FALL, {}):
            result_of(session, **changes)
    assert state_of(one) == state_of(other)


def test_another_seed_gives_another_session():
    hashes = set()
    for seed in (0, 1):
        session = new_session(seed)
        result_of(session)
        hashes.add(session.learner.memory_sha256())
    assert len(hashes) == 2


# -- trials ----------------------------------------------------------------------------


def test_before_the_schedule_is_complete_there_is_no_trial():
    session = new_session()
    due = []
    for _ in range(SCHEDULE_EPISODES):
        due.append(session.trial_due)
        result_of(session)
    assert due == [False] * SCHEDULE_EPISODES


def test_the_walk_that_completes_the_schedule_is_followed_by_a_trial():
    assert with_schedule_complete().trial_due


def test_a_trial_does_not_learn():
    assert not result_of(with_schedule_complete()).learning


@pytest.mark.parametrize("changes", [{}, FALL], ids=["completed", "failed"])
def test_a_trial_leaves_the_memory_alone(changes):
    session = with_schedule_complete()
    before = session.learner.memory_sha256()
    result_of(session, **changes)
    assert session.learner.memory_sha256() == before


@pytest.mark.parametrize("changes", [{}, FALL], ids=["completed", "failed"])
def test_a_trial_leaves_schedule_and_random_numbers_alone(changes):
    session = with_schedule_complete()
    before = json.dumps(session.learner.progress())
    result_of(session, **changes)
    assert json.dumps(session.learner.progress()) == before


def test_a_trial_is_no_episode():
    session = with_schedule_complete()
    result_of(session)
    assert session.episodes == SCHEDULE_EPISODES


def test_a_trial_is_of_the_whole_walk():
    assert result_of(with_schedule_complete()).target_ticks == WALK_TICKS


def test_a_trial_is_greedy():
    session = with_schedule_complete()
    copy = copy_of(session)
    expected = [copy.greedy().respond(observation(0)) for _ in range(2)]
    np.testing.assert_array_equal([begin(session), begin(session)], expected)


def test_a_trial_that_completes_the_walk_shows_that_it_is_learned():
    assert learned_session().learned


def test_without_a_trial_nothing_is_learned_yet():
    assert not with_schedule_complete().learned


def test_a_trial_that_fails_shows_nothing():
    session = with_schedule_complete()
    result_of(session, **FALL)
    assert not session.learned


def test_after_a_trial_that_failed_learning_goes_on():
    session = with_schedule_complete()
    result_of(session, **FALL)
    assert result_of(session).learning


def test_after_a_trial_that_failed_a_completed_walk_is_tried_again():
    session = with_schedule_complete()
    result_of(session, **FALL)
    result_of(session)
    assert session.trial_due


def test_an_episode_that_failed_is_not_followed_by_a_trial():
    session = with_schedule_complete()
    result_of(session, **FALL)
    result_of(session, **FALL)
    assert not session.trial_due


def test_what_is_learned_is_not_tried_again():
    session = learned_session()
    assert result_of(session).learning
    assert not session.trial_due


def test_the_result_of_a_trial_says_that_the_schedule_is_complete():
    assert result_of(with_schedule_complete()).schedule_complete


# -- counts ----------------------------------------------------------------------------


def test_episodes_and_trials_are_counted_apart():
    session = with_schedule_complete()
    result_of(session, **FALL)
    tally = session.tally
    assert (tally.simulated_ticks, tally.evaluation_ticks, tally.evaluations) == (
        2 * 30 + 2 * 50,
        20,
        1,
    )


def test_it_is_kept_when_schedule_and_walk_were_learned():
    session = with_schedule_complete()
    for changes in (FALL, {}, {}, {}):  # trial, episode, trial, episode
        result_of(session, **changes)
    tally = session.tally
    assert (tally.schedule_episodes, tally.greedy_episodes) == (4, 5)


def chained(*hashes):
    session = new_session()
    for sha in hashes:
        result_of(session, sha=sha)
    return session.tally.trajectories_sha256


def test_the_hash_of_a_session_tells_the_order_of_its_walks():
    assert chained("a", "b") != chained("b", "a")


def test_a_trial_does_not_enter_the_hash():
    session = with_schedule_complete()
    before = session.tally.trajectories_sha256
    result_of(session)
    assert session.tally.trajectories_sha256 == before


@pytest.mark.parametrize("cause", [EndCause.PEER_SILENT, EndCause.RESET])
def test_an_end_from_outside_at_the_start_gives_a_result(cause):
    session = new_session()
    begin(session)
    result = session.respond(observation(0, clock_ticks=1, end_cause=cause))
    assert (result.end_cause, session.walking) == (cause, False)


# -- walks joined in their middle ------------------------------------------------------


@pytest.mark.parametrize("cause", [None, EndCause.ZMP_ERROR, EndCause.PEER_SILENT])
def test_a_walk_joined_in_its_middle_changes_nothing(cause):
    session = with_mixed_walks(3)
    before = state_of(session)
    result = session.respond(observation(20, end_cause=cause))
    assert not result.learning
    assert result.end_cause is (cause or EndCause.PEER_SILENT)
    assert state_of(session) == before


@pytest.mark.parametrize("other", [{"episode": 1}, {"simulation": "another"}])
def test_the_middle_of_another_walk_is_not_taken_for_that_of_this_one(other):
    session = new_session()
    begin(session)
    result = session.respond(observation(10, **other))
    assert (result.learning, session.episodes) == (False, 0)


def test_after_a_walk_joined_in_its_middle_the_next_one_is_learned_from():
    session = new_session()
    session.respond(observation(20))
    assert result_of(session).learning


# -- frozen by a user ------------------------------------------------------------------


def frozen_session():
    session = new_session()
    result_of(session)
    session.frozen = True
    return session


def test_a_frozen_session_does_not_learn():
    assert not result_of(frozen_session()).learning


@pytest.mark.parametrize("changes", [{}, FALL], ids=["completed", "failed"])
def test_a_frozen_session_changes_nothing_that_was_learned(changes):
    session = frozen_session()
    before = session.learner.memory_sha256(), json.dumps(session.learner.progress())
    result_of(session, **changes)
    after = session.learner.memory_sha256(), json.dumps(session.learner.progress())
    assert after == before


def test_a_frozen_session_walks_greedily():
    session = frozen_session()
    expected = session.greedy().respond(observation(0))
    found = [begin(session) for _ in range(3)]
    np.testing.assert_array_equal(found, [expected] * 3)


def test_a_frozen_walk_is_no_episode():
    session = frozen_session()
    result_of(session)
    assert session.episodes == 1


def test_a_frozen_walk_before_the_schedule_is_complete_shows_nothing():
    session = frozen_session()
    result_of(session)
    assert not session.learned


def test_freezing_takes_effect_with_the_next_walk():
    session = new_session()
    begin(session)
    session.frozen = True
    result = session.respond(observation(10, end_cause=EndCause.ZMP_ERROR))
    assert result.learning


def test_a_session_no_longer_frozen_learns_on():
    session = frozen_session()
    result_of(session)
    session.frozen = False
    assert result_of(session).learning


# -- checkpoints -----------------------------------------------------------------------


def with_mixed_walks(walks, trial_fails=True):
    """A session after so many walks, some of which fail."""
    session = new_session()
    for number in range(walks):
        fails = number % 3 == 1 or (session.trial_due and trial_fails)
        result_of(session, **(FALL if fails else {}))
    return session


SESSIONS = {
    "new": new_session,
    "after_failures": lambda: with_mixed_walks(3),
    "trial_due": with_schedule_complete,
    "trial_failed": lambda: with_mixed_walks(9),
    "learned": learned_session,
}
EVERY_SESSION = pytest.mark.parametrize("made", SESSIONS.values(), ids=SESSIONS)


@EVERY_SESSION
def test_a_restored_session_is_what_it_was(made):
    session = made()
    assert state_of(copy_of(session)) == state_of(session)


@EVERY_SESSION
def test_a_restored_session_goes_on_as_if_never_interrupted(made):
    session = made()
    copy = copy_of(session)
    for changes in ({}, FALL, {}, {}, FALL, {}):
        ways = [walk(each, **changes) for each in (session, copy)]
        np.testing.assert_equal(ways[0], ways[1])
    assert state_of(copy) == state_of(session)


def test_a_trial_that_is_due_is_still_due_after_a_restart():
    copy = copy_of(with_schedule_complete())
    assert copy.trial_due
    assert not result_of(copy).learning


def test_a_restored_session_has_the_seed_of_the_saved_one():
    assert copy_of(new_session(seed=5)).seed == 5


@pytest.mark.parametrize("missing", ["seed", "progress", "trial_due", "tally"])
def test_a_header_without_a_part_is_refused(missing):
    session = with_schedule_complete()
    header = session.header()
    del header[missing]
    with pytest.raises(KeyError, match=missing):
        new_session().restore(header, session.arrays())


def test_an_array_of_nobody_is_refused():
    session = with_schedule_complete()
    arrays = {**session.arrays(), "mood": np.zeros(3)}
    with pytest.raises(KeyError, match="mood"):
        new_session().restore(session.header(), arrays)


def test_memory_of_other_settings_is_refused():
    settings = replace(SETTINGS, action=ActionSettings(alternatives=9))
    other = LearningSession(settings, WALK_TICKS, 0)
    session = with_schedule_complete()
    with pytest.raises(ValueError, match="array q"):
        other.restore(session.header(), session.arrays())


# -- status ----------------------------------------------------------------------------


def test_the_status_of_a_new_session():
    status = new_session(seed=7).status("me", active=True)
    assert status == LearnerStatus(
        instance="me",
        active=True,
        seed=7,
        target_time_s=0.06,
        subtask=0,
        subtasks=2,
        successes=0,
        episodes=0,
        survival=0.0,
        basis_states=0,
        fixed_states=0,
        penalty_states=0,
        t_err_estimate=None,
        schedule_complete=False,
        learned=False,
        frozen=False,
        simulated_s=0.0,
        memory_sha256=new_session().learner.memory_sha256(),
        trajectory_sha256="",
    )


def test_the_status_tells_how_far_the_schedule_has_come():
    session = new_session()
    for _ in range(3):
        result_of(session)
    status = session.status("me", active=True)
    found = status.subtask, status.successes, status.target_time_s
    assert found == (1, 1, pytest.approx(0.1))


def test_the_status_tells_the_estimate():
    session = new_session()
    result_of(session, t_err=2.0)
    assert session.status("me", active=True).t_err_estimate == pytest.approx(2.1)


def test_the_status_tells_episodes_and_their_simulated_time():
    session = new_session()
    result_of(session)
    result_of(session, **FALL)
    status = session.status("me", active=True)
    assert (status.episodes, status.simulated_s) == (2, pytest.approx(0.1))


def test_the_status_tells_survival():
    session = new_session()
    result_of(session)
    result_of(session, **FALL)
    assert session.status("me", active=True).survival == pytest.approx(50 / 60)


def test_the_status_tells_the_states_of_the_memory():
    session = learned_session()
    agent, status = session.learner.agent, session.status("me", active=True)
    found = status.basis_states, status.fixed_states, status.penalty_states
    assert found == (agent.basis_states, agent.fixed_states, agent.penalty_states)
    assert status.basis_states > 0


def test_the_status_tells_both_hashes():
    session = learned_session()
    status = session.status("me", active=True)
    assert (status.memory_sha256, status.trajectory_sha256) == (
        session.learner.memory_sha256(),
        session.tally.trajectories_sha256,
    )


@pytest.mark.parametrize(
    "made, complete, learned",
    [
        (new_session, False, False),
        (with_schedule_complete, True, False),
        (learned_session, True, True),
    ],
)
def test_the_status_tells_what_is_learned(made, complete, learned):
    status = made().status("me", active=True)
    assert (status.schedule_complete, status.learned) == (complete, learned)


def test_the_status_tells_that_a_session_is_frozen():
    assert frozen_session().status("me", active=True).frozen


@pytest.mark.parametrize("active", [True, False])
def test_the_status_tells_whether_the_learner_takes_part(active):
    assert new_session().status("me", active).active == active


def test_the_status_goes_over_the_wire():
    status = learned_session().status("me", active=True)
    assert decode(LearnerStatus, encode(status)) == status
