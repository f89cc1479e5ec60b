"""Walks that end from outside, or of which a part is missing, leave nothing behind."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.learner_node.walking.observations import observation, ticks_until
from tests.learner_node.walking.sessions import (
    FALL,
    WALK_TICKS,
    begin,
    copy_of,
    learned_session,
    new_session,
    result_of,
    state_of,
    walk,
    with_mixed_walks,
    with_schedule_complete,
)
from tests.learner_node.walking.small_settings import SETTINGS

from learner_node.walking.session import LearningSession
from msgs_json.end_cause import EndCause

FROM_OUTSIDE = [cause for cause in EndCause if cause.from_outside]
CUT_OFF, JOINED = "cut off by the next", "joined in its middle"
SESSIONS = pytest.mark.parametrize(
    "made", [new_session, lambda: with_mixed_walks(3), with_schedule_complete,
             learned_session],
    ids=["new", "after failures", "trial due", "learned"],
)  # fmt: skip


def give_up(session, way, until=20, astray_m=0.0):
    """Walk until a control tick, where the walk ends in this way."""
    if way is JOINED:
        return session.respond(observation(until + 10, episode=7))
    for tick in dict.fromkeys(ticks_until(until)):
        session.respond(observation(tick, waist_in_support_foot_m=(tick, astray_m)))
    if way is CUT_OFF:
        return None
    return session.respond(observation(until, clock_ticks=1, end_cause=way))


def kept(session):
    """All that a checkpoint holds but the count of walks given up."""
    header, arrays = json.loads(state_of(session))
    del header["tally"]["given_up"]
    return header, arrays


given_up_walks = st.tuples(
    st.sampled_from([*FROM_OUTSIDE, CUT_OFF, JOINED]),
    st.sampled_from([0, 10, 20]),
    st.sampled_from([0.0, 0.1]),
)


@pytest.mark.parametrize("method", ["xol", "q_lambda"])
@settings(deadline=None, max_examples=60)
@given(
    st.lists(
        st.tuples(st.lists(given_up_walks, max_size=3), st.sampled_from([{}, FALL])),
        max_size=10,
    )
)
def test_a_run_is_the_same_with_and_without_them(method, run):
    undisturbed, disturbed = (
        LearningSession(replace(SETTINGS, method=method), WALK_TICKS, seed=0)
        for _ in range(2)
    )
    for number, (given_up, changes) in enumerate(run):
        for way in given_up:
            give_up(disturbed, *way)
        sha = f"walk {number}"
        np.testing.assert_equal(
            walk(disturbed, sha=sha, **changes), walk(undisturbed, sha=sha, **changes)
        )
    assert kept(disturbed) == kept(undisturbed)
    assert disturbed.memory_sha256() == undisturbed.memory_sha256()


@SESSIONS
@pytest.mark.parametrize("cause", FROM_OUTSIDE)
def test_the_end_from_outside_is_answered_with_a_result(made, cause):
    result = give_up(made(), cause)
    assert (result.end_cause, result.control_ticks) == (cause, 20)


@SESSIONS
@pytest.mark.parametrize("cause", FROM_OUTSIDE)
def test_the_same_walk_is_walked_again(made, cause):
    session = made()
    undisturbed = copy_of(session)
    give_up(session, cause)
    np.testing.assert_equal(walk(session), walk(undisturbed))


@pytest.mark.parametrize(
    "way, cause",
    [*zip(FROM_OUTSIDE, FROM_OUTSIDE, strict=True), (CUT_OFF, EndCause.PEER_SILENT)],
)
def test_walks_that_are_given_up_are_counted_by_cause(way, cause):
    session = new_session()
    for _ in range(2):
        give_up(session, way)
        result_of(session)
    assert session.tally.given_up == {cause: 2}


def test_a_walk_joined_in_its_middle_is_counted_once():
    session = new_session()
    for tick in (10, 20, 30):
        session.respond(observation(tick, episode=7))
    assert session.tally.given_up == {EndCause.PEER_SILENT: 1}


def test_a_walk_that_fails_by_itself_is_not_given_up():
    session = new_session()
    result_of(session, **FALL)
    assert session.tally.given_up == {}


def test_a_walk_that_is_frozen_is_counted_as_well():
    session = new_session()
    session.frozen = True
    give_up(session, EndCause.LATE)
    assert (session.tally.given_up, session.tally.evaluations) == (
        {EndCause.LATE: 1},
        0,
    )


def test_a_trial_that_is_given_up_is_still_due():
    session = with_schedule_complete()
    give_up(session, EndCause.LATE)
    assert session.trial_due


def test_the_count_is_told():
    session = new_session()
    give_up(session, EndCause.LATE)
    assert session.status("me").given_up == {EndCause.LATE: 1}


def test_the_count_outlives_a_restart():
    session = new_session()
    give_up(session, EndCause.LATE)
    assert copy_of(session).tally == session.tally


def test_a_checkpoint_from_before_there_was_a_count_is_taken():
    session = with_mixed_walks(3)
    header = session.header()
    del header["tally"]["given_up"]
    restored = new_session()
    restored.restore(header, session.arrays())
    assert (restored.episodes, restored.tally.given_up) == (3, {})


@pytest.mark.parametrize("count", [{"mood": 1}, {"late": "often"}, 7, None])
def test_a_count_that_is_none_is_refused(count):
    header = new_session().header()
    header["tally"]["given_up"] = count
    with pytest.raises((TypeError, ValueError)):
        new_session().restore(header, new_session().arrays())


def test_the_walk_after_a_cut_off_one_is_learned_from():
    session = new_session()
    begin(session)
    assert result_of(session).learning
