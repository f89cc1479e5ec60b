"""Real time: what is due when, what is late, and what is said of it."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from tests.robots import SHIPPED

from msgs_json.end_cause import EndCause
from sim_node.pace_watch import PaceWatch
from sim_node.pilot import Pilot
from sim_node.realtime import Punctuality, RealtimeLoop
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

TIMEOUT_S = 30.0
SLOWLY = 0.2  # simulated seconds per second, so that a busy machine makes nobody late
LEARNING_TICK_S = 0.02 / SLOWLY
WALK_TICKS = 40


def segments_of(look_ahead_ticks=50):
    """The walk's first segments, without correction."""
    reference = WaistReference(
        SHIPPED, GaitSettings(), CorrectionSettings(), look_ahead_ticks
    )
    return [reference.segment(np.zeros(2)) for _ in range(WALK_TICKS // 10)]


class Guided:
    """A robot in real time, its first observations answered and the others not."""

    def __init__(self, robot, segments, answers):
        self.observations = []
        self.punctuality = Punctuality()
        self.pilot = Pilot(robot)
        self._segments = segments[:answers]
        self._silent = threading.Event()
        self.loop = RealtimeLoop(
            self.pilot, WALK_TICKS, SLOWLY, self.observed, self.punctuality
        )

    def observed(self, observation):
        self.observations.append(observation)
        number = observation.control_tick // 10
        if number < len(self._segments) and observation.end_cause is None:
            self.answer(observation.clock_ticks, self._segments[number])
        else:
            self._silent.set()

    def answer(self, clock_ticks, segment):
        self.loop.request(lambda: self.pilot.follow(clock_ticks, segment))
        self.loop.request(self.loop.segment_arrived)

    def walk(self):
        """Walk until some time after the first observation that is not answered."""
        self.loop.start()
        try:
            self.loop.request(self.loop.begin)
            assert self._silent.wait(TIMEOUT_S)
            time.sleep(3 * LEARNING_TICK_S)
        finally:
            self.loop.stop()
        return self.observations


class HeldUp(Guided):
    """One whose thread is held up at an observation, which is answered in time."""

    def observed(self, observation):
        if observation.control_tick == 20:
            time.sleep(3 * LEARNING_TICK_S)
        super().observed(observation)

    def answer(self, clock_ticks, segment):
        answer = super().answer
        threading.Timer(
            0.3 * LEARNING_TICK_S, lambda: answer(clock_ticks, segment)
        ).start()


@pytest.fixture
def robot(new_walker):
    return new_walker().robot


# -- deadlines -------------------------------------------------------------------------


def test_a_segment_that_the_legs_cannot_follow_ends_the_walk_and_is_told(robot):
    first, second, *_ = segments_of()
    too_high = replace(second, waist=second.waist + np.array([0.0, 0.0, 0.2]))
    told = Guided(robot, [first, too_high], answers=2).walk()
    assert told[-1].end_cause is EndCause.IK_UNREACHABLE
    assert told[-1].control_tick == told[-2].control_tick == 10
    assert told[-1].clock_ticks > told[-2].clock_ticks


def test_a_walk_that_is_answered_in_time_is_walked_to_its_end(robot):
    guided = Guided(robot, segments_of(), answers=4)
    assert [each.control_tick for each in guided.walk()] == [0, 10, 20, 30, 40]
    assert guided.punctuality.missed_deadlines == 0


@pytest.mark.parametrize(("look_ahead_ticks", "end_tick"), [(1, 20), (5, 24), (50, 30)])
def test_the_first_deadline_that_is_missed_ends_the_walk_as_late(
    robot, look_ahead_ticks, end_tick
):
    guided = Guided(robot, segments_of(look_ahead_ticks), answers=2)
    last = guided.walk()[-1]
    assert (last.end_cause, last.control_tick) == (EndCause.LATE, end_tick)
    assert guided.punctuality.missed_deadlines == 1


def test_before_its_first_segment_the_robot_waits_for_as_long_as_it_takes(robot):
    assert len(Guided(robot, segments_of(), answers=0).walk()) == 1


def test_a_failure_before_the_deadline_is_not_taken_for_lateness(robot):
    (first, *_) = segments_of()
    waist = first.waist.copy()
    waist[14:, 0] += 0.05
    last = Guided(robot, [replace(first, waist=waist)], answers=1).walk()[-1]
    assert last.end_cause is EndCause.ZMP_ERROR
    assert 10 < last.control_tick < 20


def test_who_answers_has_the_whole_learning_tick_after_the_robot_was_held_up(robot):
    guided = HeldUp(robot, segments_of(), answers=4)
    assert guided.walk()[-1].control_tick == WALK_TICKS
    assert guided.punctuality.missed_deadlines == 0
    assert guided.punctuality.lost_ns > 2e9 * LEARNING_TICK_S


# -- what is said ----------------------------------------------------------------------


def looks(*changes, factor=1.0):
    """Return what the watch says after each change of the counts."""
    punctuality = Punctuality()
    watch = PaceWatch(punctuality)
    said = []
    for ticks, lost_ms, missed in changes:
        punctuality.ticks += ticks
        punctuality.lost_ns += lost_ms * 1_000_000
        punctuality.missed_deadlines += missed
        said.append(watch.look(factor))
    return said


def test_nothing_is_said_where_real_time_is_kept():
    assert looks(*[(50, 5, 0)] * 10) == [None] * 10


def test_nothing_is_said_while_nobody_walks():
    assert looks(*[(0, 0, 0)] * 3) == [None] * 3


def test_a_pace_that_is_not_kept_is_said_with_figure_and_advice():
    *_, last = looks(*[(30, 40, 0)] * 5)
    assert last == (
        "real time is not kept: 0.60 simulated s per s, 1 asked for, missed deadlines "
        "0; walk in lockstep, or slower with realtime_factor 0.5"
    )


def test_a_missed_deadline_is_said_at_once():
    said = looks((50, 0, 0), (50, 0, 1))
    assert (said[0], "missed deadlines 1" in said[1]) == (None, True)


def test_what_is_long_past_is_not_said_again():
    assert looks((50, 0, 1), *[(50, 0, 0)] * 6)[-1] is None


def test_the_pace_is_that_of_the_factor_asked_for():
    # 0.1 simulated s in 0.2 s, and as long lost.
    (said,) = looks((50, 200, 0), factor=0.5)
    assert "0.25 simulated s per s, 0.5 asked for" in said
    assert said.endswith("realtime_factor 0.25")
