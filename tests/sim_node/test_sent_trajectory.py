"""What a robot is sent: no step from one trajectory to the next, nor to rest."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim_node.sent_trajectory import (
    AS_BEFORE_TICKS,
    GOES_ON_TICKS,
    STAYS_TICKS,
    SentTrajectory,
)

LENGTH, LATER = 60, 10
FAR_RAD = 1e-5


def way(offset_rad=0.0):
    """All joints at 1 mrad per tick, from the first tick on."""
    rows = 1e-3 * np.arange(1, LENGTH + 1) + offset_rad
    return np.repeat(rows[:, None], 12, axis=1)


def continued(offset_rad):
    """What is wanted ten ticks later, off by so much."""
    return way(offset_rad) + 1e-3 * LATER


def test_the_first_one_is_sent_as_it_is():
    assert np.array_equal(SentTrajectory().next(0, way()), way())


def test_the_next_one_begins_as_the_last_and_ends_as_it_is_wanted():
    sent = SentTrajectory()
    sent.next(0, way())
    asked = sent.next(LATER, continued(FAR_RAD))
    known = way()[LATER:]
    assert np.array_equal(asked[:AS_BEFORE_TICKS], known[:AS_BEFORE_TICKS])
    assert np.allclose(asked[len(known) - 1 :], continued(FAR_RAD)[len(known) - 1 :])


@given(st.lists(st.floats(-FAR_RAD, FAR_RAD), min_size=2, max_size=20))
def test_no_trajectory_has_a_step(offsets_rad):
    sent = SentTrajectory()
    for i, offset_rad in enumerate(offsets_rad):
        wanted = way(offset_rad) + 1e-3 * LATER * i
        asked = sent.next(LATER * i, wanted)
        # A step at once could be of 2 FAR_RAD.
        assert np.abs(np.diff(asked, n=2, axis=0)).max() < 0.05 * FAR_RAD
        assert np.abs(asked - wanted).max() <= 2.0 * FAR_RAD + 1e-12


def test_what_is_too_short_to_lead_over_is_sent_as_it_is():
    sent = SentTrajectory()
    sent.next(0, way()[:LATER])
    assert np.array_equal(sent.next(LATER, continued(FAR_RAD)), continued(FAR_RAD))


def test_what_was_forgotten_leads_nowhere():
    sent = SentTrajectory()
    sent.next(0, way())
    sent.forget()
    assert np.array_equal(sent.next(LATER, continued(FAR_RAD)), continued(FAR_RAD))


@pytest.mark.parametrize("tick", [0, 7, LENGTH - 3, LENGTH + 5])
def test_joints_go_on_for_a_moment_and_stay(tick):
    sent = SentTrajectory()
    sent.next(0, way())
    asked = sent.stay(tick)
    assert len(asked) == STAYS_TICKS
    moving = max(0, min(GOES_ON_TICKS, LENGTH - tick))
    assert np.array_equal(asked[:moving], way()[tick : tick + moving])
    assert np.ptp(asked[max(moving - 1, 0) :], axis=0).max() == 0.0
    assert sent.stay(tick) is None  # asked once


def test_who_was_sent_nothing_stays_anyway():
    assert SentTrajectory().stay(0) is None


@pytest.mark.parametrize(
    ("tick", "row"), [(0, 0), (1, 0), (2, 1), (LENGTH, -1), (LENGTH + 9, -1)]
)
def test_where_the_joints_are_asked_to_be_after_a_tick(tick, row):
    sent = SentTrajectory()
    assert sent.asked(tick) is None
    sent.next(0, way())
    assert np.array_equal(sent.asked(tick), way()[row])
