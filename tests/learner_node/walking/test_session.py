"""Learning and frozen trials, walk after walk, fed with observations made by hand."""

import json

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation
from tests.learner_node.walking.sessions import (
    FALL,
    SCHEDULE_EPISODES,
    WALK_TICKS,
    begin,
    copy_of,
    frozen_session,
    learned_session,
    new_session,
    result_of,
    state_of,
    walk,
    with_mixed_walks,
    with_schedule_complete,
)

from msgs_json.end_cause import EndCause

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
        hashes.add(session.memory_sha256())
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
    before = session.memory_sha256()
    result_of(session, **changes)
    assert session.memory_sha256() == before


@pytest.mark.parametrize("changes", [{}, FALL], ids=["completed", "failed"])
def test_a_trial_leaves_schedule_and_random_numbers_alone(changes):
    session = with_schedule_complete()
    before = json.dumps(session.header()["progress"])
    result_of(session, **changes)
    assert json.dumps(session.header()["progress"]) == before


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


def test_a_frozen_session_does_not_learn():
    assert not result_of(frozen_session()).learning


@pytest.mark.parametrize("changes", [{}, FALL], ids=["completed", "failed"])
def test_a_frozen_session_changes_nothing_that_was_learned(changes):
    session = frozen_session()
    before = session.memory_sha256(), json.dumps(session.header()["progress"])
    result_of(session, **changes)
    after = session.memory_sha256(), json.dumps(session.header()["progress"])
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
