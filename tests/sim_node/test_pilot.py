"""Guiding one robot: what is accepted, and when a walk begins anew."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
from tests.learner_node.walking.observations import observation

from learner_node.walking.cost import CostIntegral
from learner_node.walking.settings import CostSettings
from msgs_json.end_cause import EndCause
from msgs_json.wire import RefusedMessageError
from sim_node.pilot import Pilot

# Even standing sinks in by more.
FALLING = {"foot_penetration_m": 1e-9}


@pytest.fixture
def new_pilot(new_walker) -> Callable[..., Pilot]:
    """Build pilots of robots that are closed when the test is over."""
    return lambda **limits: Pilot(new_walker(limits).robot)


@pytest.fixture
def pilot(new_pilot) -> Pilot:
    return new_pilot()


def execute(pilot, segments):
    """Answer every observation with the next segment; return the last observation."""
    for segment in segments:
        pilot.execute(pilot.observation.clock_ticks, segment)
    return pilot.observation


def result_of(episode):
    """A result of which only the number of the walk matters."""
    end = observation(10, episode=episode)
    return CostIntegral(CostSettings()).result(end, EndCause.COMPLETED, 10)


def refused(text):
    return pytest.raises(RefusedMessageError, match=text)


# -- walking ---------------------------------------------------------------------------


def test_before_the_first_walk_there_is_no_observation(pilot):
    assert pilot.observation is None


def test_walks_are_numbered_from_one(pilot):
    assert [pilot.begin().episode for _ in range(3)] == [1, 2, 3]


def test_a_walk_begins_standing(pilot):
    assert pilot.begin().control_tick == 0


def test_a_segment_is_walked_to_its_end(pilot, static_walk):
    pilot.begin()
    assert execute(pilot, static_walk[:2]).control_tick == 20


def test_the_last_observation_is_kept(pilot, static_walk):
    begun = pilot.begin()
    walked = pilot.execute(begun.clock_ticks, static_walk[0])
    assert pilot.observation is walked


def test_a_walk_that_fails_says_so(new_pilot, static_walk):
    pilot = new_pilot(**FALLING)
    pilot.begin()
    assert execute(pilot, static_walk[:1]).end_cause is EndCause.FOOT_THROUGH_FLOOR


def test_a_new_walk_may_begin_in_the_middle_of_another(pilot, static_walk):
    pilot.begin()
    execute(pilot, static_walk[:2])
    pilot.begin()
    assert execute(pilot, static_walk[:1]).control_tick == 10


def test_following_ahead_of_time_walks_the_same(new_pilot, static_walk):
    ahead, lockstep = new_pilot(), new_pilot()
    for pilot in (ahead, lockstep):
        pilot.begin()
    for segment in static_walk[:3]:
        ahead.follow(ahead.observation.clock_ticks, segment)
        for _ in range(10):
            ahead.biped.advance()
        ahead.observe()
    assert ahead.observation == execute(lockstep, static_walk[:3])


# -- refusals --------------------------------------------------------------------------

EVERY_WAY = pytest.mark.parametrize("way", [Pilot.execute, Pilot.follow])


@EVERY_WAY
def test_nothing_is_walked_before_a_walk_begins(pilot, static_walk, way):
    with refused("segment for clock tick 0, the robot waits at None"):
        way(pilot, 0, static_walk[0])


@EVERY_WAY
@pytest.mark.parametrize("late", [-1, 1, 10])
def test_a_segment_for_another_time_is_refused(pilot, static_walk, way, late):
    at = pilot.begin().clock_ticks
    with refused(f"segment for clock tick {at + late}, the robot waits at {at}"):
        way(pilot, at + late, static_walk[0])


def test_a_segment_that_comes_twice_is_refused(pilot, static_walk):
    at = pilot.begin().clock_ticks
    pilot.execute(at, static_walk[0])
    with refused("the robot waits at"):
        pilot.execute(at, static_walk[0])


def test_a_second_segment_for_an_observation_is_refused_while_the_first_is_walked(
    pilot, static_walk
):
    at = pilot.begin().clock_ticks
    pilot.follow(at, static_walk[0])
    pilot.biped.advance()
    elsewhere = dataclasses.replace(static_walk[0], waist=static_walk[0].waist + 0.02)
    with refused(f"a second segment for clock tick {at}, which is answered"):
        pilot.follow(at, elsewhere)
    assert pilot.segment is static_walk[0]


@EVERY_WAY
def test_a_segment_of_another_place_in_the_walk_is_refused(pilot, static_walk, way):
    at = pilot.begin().clock_ticks
    with refused("the robot is at tick 0"):
        way(pilot, at, static_walk[1])


@EVERY_WAY
@pytest.mark.parametrize("name", ["waist", "left_foot", "zmp_reference"])
def test_a_segment_that_is_no_number_is_refused(pilot, static_walk, way, name):
    at = pilot.begin().clock_ticks
    rows = np.full_like(getattr(static_walk[0], name), np.nan)
    with refused("finite"):
        way(pilot, at, dataclasses.replace(static_walk[0], **{name: rows}))


@EVERY_WAY
def test_a_walk_that_is_over_is_not_walked_on(new_pilot, static_walk, way):
    pilot = new_pilot(**FALLING)
    pilot.begin()
    end = execute(pilot, static_walk[:1])
    with refused("the walk is over: foot_through_floor"):
        way(pilot, end.clock_ticks, static_walk[1])


def test_a_refused_segment_leaves_no_trace(pilot, static_walk):
    begun = pilot.begin()
    with refused("the robot is at tick 0"):
        pilot.execute(begun.clock_ticks, static_walk[1])
    assert pilot.observation is begun
    assert execute(pilot, static_walk[:1]).control_tick == 10


# -- ends from outside -----------------------------------------------------------------

EVERY_CAUSE = pytest.mark.parametrize("cause", [EndCause.PEER_SILENT, EndCause.RESET])


@EVERY_CAUSE
def test_a_walk_ended_from_outside_is_reported(pilot, static_walk, cause):
    pilot.begin()
    execute(pilot, static_walk[:2])
    end = pilot.end(cause)
    assert (end.end_cause, end.control_tick) == (cause, 20)


@EVERY_CAUSE
def test_the_report_of_an_end_has_a_time_of_its_own(pilot, static_walk, cause):
    pilot.begin()
    before = execute(pilot, static_walk[:2])
    assert pilot.end(cause).clock_ticks == before.clock_ticks + 1


def test_a_walk_ended_from_outside_is_over(pilot, static_walk):
    pilot.begin()
    end = pilot.end(EndCause.RESET)
    with refused("the walk is over: reset"):
        pilot.execute(end.clock_ticks, static_walk[0])


def test_before_the_first_walk_there_is_nothing_to_end(pilot):
    assert pilot.end(EndCause.RESET) is None


def test_a_walk_does_not_end_twice(pilot):
    pilot.begin()
    pilot.end(EndCause.PEER_SILENT)
    assert pilot.end(EndCause.RESET) is None


def test_the_cause_of_a_failure_is_not_replaced(new_pilot, static_walk):
    pilot = new_pilot(**FALLING)
    pilot.begin()
    pilot.follow(pilot.observation.clock_ticks, static_walk[0])
    pilot.biped.advance()
    assert pilot.end(EndCause.RESET).end_cause is EndCause.FOOT_THROUGH_FLOOR


@pytest.mark.parametrize("limits", [{}, FALLING], ids=["sound", "failed"])
def test_a_walk_whose_deadline_is_missed_ends_as_late(new_pilot, static_walk, limits):
    pilot = new_pilot(**limits)
    pilot.begin()
    pilot.follow(pilot.observation.clock_ticks, static_walk[0])
    pilot.biped.advance()
    assert pilot.miss().end_cause is EndCause.LATE
    assert pilot.observation.end_cause is EndCause.LATE
    assert not pilot.walking


def test_the_next_walk_after_an_end_is_walked(pilot, static_walk):
    pilot.begin()
    pilot.end(EndCause.RESET)
    pilot.begin()
    assert execute(pilot, static_walk[:1]).end_cause is None


# -- results ---------------------------------------------------------------------------


def test_the_result_of_the_present_walk_is_accepted(pilot):
    pilot.begin()
    pilot.begin()
    pilot.check_result(result_of(2))


@pytest.mark.parametrize("episode", [1, 3])
def test_the_result_of_another_walk_is_refused(pilot, episode):
    pilot.begin()
    pilot.begin()
    with refused(f"result of walk {episode}, the present one is 2"):
        pilot.check_result(result_of(episode))
