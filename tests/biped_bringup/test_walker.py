"""A walk in one process: whoever answers the observations decides how it goes."""

from collections.abc import Iterator

import numpy as np
import pytest
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.walker import Walker
from biped_common.timing import TICKS_PER_LEARNING_TICK
from learner_node.walking.task import NO_CORRECTION_M
from learner_node.walking.walks import FrozenWalk, static_walk
from msgs_json.end_cause import EndCause
from sim_node.control_tick import ControlTick

SETTINGS = quick(*SHORT)


class RecordedWalker:
    """A walker, and the control ticks it has walked."""

    def __init__(self) -> None:
        self.ticks: list[ControlTick] = []
        self.walker = Walker(SETTINGS, np.random.default_rng(0), self.ticks.append)

    def static(self, target_ticks: int) -> FrozenWalk:
        return static_walk(SETTINGS.learner, target_ticks)


@pytest.fixture
def recorded() -> Iterator[RecordedWalker]:
    recorded = RecordedWalker()
    yield recorded
    recorded.walker.close()


def test_a_walk_ends_at_its_target(recorded):
    result = recorded.walker.walk(recorded.static(200))
    assert (result.end_cause, result.control_ticks) == (EndCause.COMPLETED, 200)


def test_every_control_tick_is_told(recorded):
    recorded.walker.walk(recorded.static(200))
    assert [tick.control_tick for tick in recorded.ticks] == list(range(1, 201))


def test_the_whole_walk_is_walked_to_its_last_tick(recorded):
    ticks = recorded.walker.walk_ticks
    assert ticks % TICKS_PER_LEARNING_TICK, "the last segment should be a short one"
    result = recorded.walker.walk(recorded.static(ticks))
    assert len(recorded.ticks) == result.control_ticks == ticks


def test_walks_are_numbered_from_one(recorded):
    numbers = [recorded.walker.walk(recorded.static(20)).episode for _ in range(3)]
    assert numbers == [1, 2, 3]


def test_a_second_walk_is_as_if_it_were_the_first(recorded):
    walks = []
    for _ in range(2):
        recorded.walker.walk(recorded.static(600))
        walks.append(recorded.walker.biped.trajectory_sha256)
    assert walks[0] == walks[1]


def test_a_walk_after_a_fall_is_as_if_it_were_the_first(recorded):
    recorded.walker.walk(recorded.static(600))
    first = recorded.walker.biped.trajectory_sha256
    leaning = FrozenWalk(SETTINGS.learner, 10_000, lambda _: np.array([0.2, 0.2]))
    assert not recorded.walker.walk(leaning).completed
    recorded.walker.walk(recorded.static(600))
    assert recorded.walker.biped.trajectory_sha256 == first


def test_what_the_responder_answers_moves_the_robot(recorded):
    def lean(_):
        return np.array([0.0, 0.01])

    recorded.walker.walk(FrozenWalk(SETTINGS.learner, 200, lean))
    leaning = recorded.walker.biped.trajectory_sha256
    recorded.walker.walk(recorded.static(200))
    assert recorded.walker.biped.trajectory_sha256 != leaning


def test_the_responder_is_asked_once_per_learning_tick(recorded):
    asked = []

    def decide(observation):
        asked.append(observation.control_tick)
        return NO_CORRECTION_M

    recorded.walker.walk(FrozenWalk(SETTINGS.learner, 200, decide))
    assert asked == list(range(0, 200, TICKS_PER_LEARNING_TICK))


def test_a_walker_can_be_closed_twice(recorded):
    recorded.walker.close()
    recorded.walker.close()
    assert recorded.walker.biped.world.client == 0
