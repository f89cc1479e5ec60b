"""A session goes on from a checkpoint as if never interrupted."""

import json
from dataclasses import replace

import msgspec
import numpy as np
import pytest
from tests.learner_node.walking.sessions import (
    FALL,
    WALK_TICKS,
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
from learner_node.walking.settings import (
    ActionSettings,
)

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
    with pytest.raises(msgspec.ValidationError, match=missing):
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


def test_progress_of_another_schedule_is_refused():
    session = new_session()
    header = json.loads(json.dumps(session.header()))
    header["progress"]["subtask"] = 7
    with pytest.raises(ValueError, match="subtask 7 of 2"):
        new_session().restore(header, session.arrays())
