"""An observation and its correction, in any order, make one segment."""

import dataclasses

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation
from tests.robots import SHIPPED

from msgs_json.end_cause import EndCause
from msgs_json.wire import RefusedMessageError
from trajectory_node.segment_maker import SegmentMaker
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

LIMIT_M = 0.024
LEAN = np.array([0.01, -0.02])
WALK = 5625  # control ticks
START = 100  # of the simulation's clock


def new_reference():
    return WaistReference(SHIPPED, GaitSettings(), CorrectionSettings())


@pytest.fixture
def maker():
    return SegmentMaker(new_reference(), LIMIT_M)


def seen(control_tick, start=START, **changes):
    """What the robot observes in a walk that began at some time of the clock."""
    return observation(control_tick, clock_ticks=start + control_tick, **changes)


def join(maker, control_tick, correction_m=LEAN, start=START):
    """Give an observation, then its correction; return the segment."""
    assert maker.observe(seen(control_tick, start)) is None
    return maker.correct(start + control_tick, correction_m)


def refused(text):
    return pytest.raises(RefusedMessageError, match=text)


def assert_same(found, expected):
    np.testing.assert_equal(dataclasses.asdict(found), dataclasses.asdict(expected))


# -- joining ---------------------------------------------------------------------------


def test_an_observation_alone_makes_no_segment(maker):
    assert maker.observe(seen(0)) is None


def test_a_correction_alone_makes_no_segment(maker):
    join(maker, 0)
    assert maker.correct(START + 10, LEAN) is None


def test_a_correction_after_its_observation_makes_the_segment(maker):
    assert_same(join(maker, 0), new_reference().segment(LEAN))


def test_a_correction_before_its_observation_makes_the_same_segment(maker):
    reference = new_reference()
    join(maker, 0)
    maker.correct(START + 10, -LEAN)
    reference.segment(LEAN)
    assert_same(maker.observe(seen(10)), reference.segment(-LEAN))


def test_the_very_first_correction_may_come_before_its_observation(maker):
    maker.correct(START, LEAN)
    segment = maker.observe(seen(0))
    assert segment is not None
    assert_same(segment, new_reference().segment(LEAN))


def test_a_correction_before_the_start_of_the_next_walk_serves_it(maker):
    join(maker, 0)
    maker.observe(seen(10, end_cause=EndCause.ZMP_ERROR))
    maker.correct(START + 500, LEAN)
    assert_same(maker.observe(seen(0, START + 500)), new_reference().segment(LEAN))


def test_a_correction_two_observations_ahead_waits_for_its_own(maker):
    join(maker, 0)
    maker.correct(START + 20, -LEAN)
    assert maker.observe(seen(10)) is None
    assert maker.correct(START + 10, LEAN).first_tick == 10
    assert maker.observe(seen(20)).first_tick == 20


def test_segments_follow_each_other(maker):
    assert [join(maker, tick).first_tick for tick in (0, 10, 20)] == [0, 10, 20]


def test_a_new_walk_starts_from_the_beginning(maker):
    first = join(maker, 0)
    join(maker, 10, -LEAN)
    assert_same(join(maker, 0, start=START + 500), first)


def test_a_walk_that_ended_needs_no_correction(maker):
    join(maker, 0)
    maker.observe(seen(10, end_cause=EndCause.ZMP_ERROR))
    with refused("which is over"):
        maker.correct(START + 10, LEAN)


def test_a_correction_at_the_limit_is_accepted(maker):
    assert join(maker, 0, np.array([LIMIT_M, -LIMIT_M])) is not None


def test_the_last_segment_is_a_short_one(maker):
    ends = [join(maker, tick).n_ticks for tick in range(0, WALK, 10)][-1]
    assert ends == WALK % 10


def test_after_the_last_segment_a_new_walk_begins(maker):
    for tick in range(0, WALK, 10):
        join(maker, tick)
    maker.observe(seen(WALK))
    assert join(maker, 0, start=START + WALK + 1).first_tick == 0


def test_a_correction_beyond_the_last_segment_is_refused(maker):
    for tick in range(0, WALK, 10):
        join(maker, tick)
    with refused("over"):
        join(maker, WALK)


# -- refused observations --------------------------------------------------------------


@pytest.mark.parametrize("control_tick", [10, 0], ids=["again", "older"])
def test_an_observation_that_is_not_new_is_refused(maker, control_tick):
    join(maker, 0)
    join(maker, 10)
    with refused(r"observation of clock tick \d+ comes after that of 110"):
        maker.observe(seen(control_tick))


def test_an_old_observation_leaves_no_trace(maker):
    join(maker, 0)
    maker.observe(seen(10))
    with refused("comes after"):
        maker.observe(seen(0))
    assert maker.correct(START + 10, LEAN).first_tick == 10


def test_a_walk_whose_start_was_not_seen_is_refused(maker):
    with refused("walk at control tick 30, its reference is at 0: waiting for the"):
        maker.observe(seen(30))


def test_a_walk_whose_start_was_not_seen_gets_no_segment(maker):
    with refused("waiting"):
        maker.observe(seen(30))
    with refused("which is over"):
        maker.correct(START + 30, LEAN)


def test_a_walk_of_which_an_observation_was_missed_is_refused(maker):
    join(maker, 0)
    with refused("walk at control tick 20, its reference is at 10"):
        maker.observe(seen(20))


def test_after_an_unknown_walk_the_next_one_is_guided(maker):
    with refused("waiting"):
        maker.observe(seen(30))
    assert join(maker, 0, start=START + 500).first_tick == 0


def test_a_simulation_started_anew_has_a_clock_of_its_own(maker):
    join(maker, 0)
    maker.observe(observation(0, clock_ticks=1, simulation="another"))
    assert maker.correct(1, LEAN).first_tick == 0


# -- refused corrections ---------------------------------------------------------------


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_correction_that_is_no_number_is_refused(maker, bad):
    with refused("must be finite"):
        join(maker, 0, np.array([0.0, bad]))


@pytest.mark.parametrize("correction", [(0.0241, 0.0), (0.0, -0.0241)])
def test_a_correction_out_of_range_is_refused(maker, correction):
    with refused(r"must be within 0\.024 m"):
        join(maker, 0, np.array(correction))


def test_a_second_correction_for_a_tick_is_refused(maker):
    join(maker, 0)
    with refused("correction for clock tick 100, which is over"):
        maker.correct(START, LEAN)


def test_a_correction_for_an_earlier_tick_is_refused(maker):
    join(maker, 0)
    maker.observe(seen(10))
    with refused("correction for clock tick 100, which is over"):
        maker.correct(START, LEAN)


@pytest.mark.parametrize(
    "clock_ticks, correction",
    [
        (START + 10, (np.nan, 0.0)),
        (START + 10, (0.1, 0.0)),
        (START, (0.0, 0.0)),
    ],
    ids=["nan", "out_of_range", "old"],
)
def test_a_refused_correction_leaves_no_trace(maker, clock_ticks, correction):
    reference = new_reference()
    reference.segment(LEAN)
    join(maker, 0)
    maker.observe(seen(10))
    with pytest.raises(RefusedMessageError):
        maker.correct(clock_ticks, np.array(correction))
    found = maker.correct(START + 10, -LEAN)
    assert_same(found, reference.segment(-LEAN))


# -- who is heard anew -----------------------------------------------------------------


def test_after_a_forged_observation_the_robot_that_is_heard_anew_is_followed(maker):
    join(maker, 0)
    maker.observe(seen(10, start=START + 10**9))
    with refused("comes after that of"):
        maker.observe(seen(0, start=START + 500))
    maker.forget()
    assert join(maker, 0, start=START + 500).first_tick == 0
