"""Replay: walks out of memory are those that the physics would compute, bit for bit."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.biped_bringup.runs import SHORT, quick

from biped_bringup.replay import NODE_BYTES, SNAPSHOT_BYTES, ReplayingWalker
from biped_bringup.walker import Walker
from learner_node.walking.walks import FrozenWalk
from msgs_json.end_cause import EndCause
from msgs_json.observation import Observation
from sim_node.errors import WorldClosedError
from trajectory_node.errors import TrajectoryError

SETTINGS = quick(*SHORT)
STILL, LEFT, RIGHT = (np.array([0.0, y]) for y in (0.0, 0.004, -0.004))
BEYOND_REACH = np.array([0.3, 0.3])
Script = list[np.ndarray]


class Scripted(FrozenWalk):
    """Corrects as it is told, one correction per learning tick, and then ends."""

    def __init__(self, corrections_m: Script) -> None:
        self.seen: list[Observation] = []
        super().__init__(
            SETTINGS.learner,
            10 * len(corrections_m),
            lambda observation: corrections_m[observation.control_tick // 10],
        )

    def respond(self, observation: Observation):
        self.seen.append(observation)
        return super().respond(observation)


@pytest.fixture
def new_walker() -> Iterator[Callable[..., ReplayingWalker]]:
    """Make replaying walkers that are closed when the test is over."""
    with ExitStack() as stack:

        def make(*memory_bytes: int) -> ReplayingWalker:
            rng = np.random.default_rng(0)
            walker = ReplayingWalker(SETTINGS, rng, *memory_bytes)
            return stack.enter_context(closing(walker))

        yield make


@pytest.fixture
def walker(new_walker) -> ReplayingWalker:
    return new_walker()


def computed_by(walker: Walker, script: Script) -> int:
    """Walk; return how many control ticks the physics was stepped for it."""
    before = walker.ticks.computed
    walker.walk(Scripted(script))
    return walker.ticks.computed - before


# -- the same bits -----------------------------------------------------------------

stretches = st.tuples(
    st.sampled_from([STILL, LEFT, RIGHT, BEYOND_REACH]), st.integers(1, 40)
)
scripts = st.lists(stretches, min_size=1, max_size=4).map(
    lambda stretches: [each for each, ticks in stretches for _ in range(ticks)]
)
memories = st.sampled_from(
    [0, 20 * NODE_BYTES, 2 * SNAPSHOT_BYTES, 5 * SNAPSHOT_BYTES, 500_000_000]
)


@settings(deadline=None, max_examples=25)
@given(st.lists(scripts, min_size=2, max_size=8), memories)
@pytest.mark.thorough
def test_all_is_observed_as_if_every_walk_were_computed(scripts, memory_bytes):
    rng = np.random.default_rng(0)
    seen, results = [], []
    for walker in (Walker(SETTINGS, rng), ReplayingWalker(SETTINGS, rng, memory_bytes)):
        with closing(walker):
            responders = [Scripted(script) for script in scripts]
            results.append([walker.walk(responder) for responder in responders])
            seen.append([responder.seen for responder in responders])
    assert seen[0] == seen[1]
    assert results[0] == results[1]


def test_a_failed_walk_fails_again(walker):
    script = [STILL] * 20 + [BEYOND_REACH] * 40
    causes = [walker.walk(Scripted(script)).end_cause for _ in range(2)]
    assert causes[0] is causes[1] is not EndCause.COMPLETED


def test_a_walk_is_replayed_to_its_last_short_tick(walker):
    script = [STILL] * (1 + walker.walk_ticks // 10)
    ticks = walker.walk_ticks
    assert ticks % 10, "the last segment should be a short one"
    results = [
        walker.walk(FrozenWalk(SETTINGS.learner, ticks, lambda _: STILL))
        for _ in range(2)
    ]
    assert len(script) * 10 > results[1].control_ticks == ticks
    assert results[0].trajectory_sha256 == results[1].trajectory_sha256
    assert walker.ticks.replayed == ticks


def test_zero_and_minus_zero_are_two_corrections(walker):
    walker.walk(Scripted([STILL] * 3))
    assert computed_by(walker, [-STILL] * 3) == 30


def test_what_is_done_with_a_correction_later_does_not_matter(walker):
    script = [LEFT.copy() for _ in range(3)]
    walker.walk(Scripted(script))
    for correction in script:
        correction[:] = RIGHT
    assert computed_by(walker, [LEFT] * 3) == 0


# -- when something goes wrong -----------------------------------------------------


class Interrupted(Scripted):
    """Fails in its third learning tick."""

    def respond(self, observation: Observation):
        if observation.control_tick == 30:
            raise KeyboardInterrupt
        return super().respond(observation)


@pytest.mark.parametrize("known", [[], [STILL] * 5], ids=["computing", "replaying"])
def test_an_interrupted_walk_leaves_the_next_ones_as_they_are(walker, known):
    scripts = [known, [STILL] * 8 + [LEFT] * 4]
    walker.walk(Scripted(scripts[0]))
    with pytest.raises(KeyboardInterrupt):
        walker.walk(Interrupted([STILL] * 5))
    again = Scripted(scripts[1])
    walker.walk(again)
    with closing(Walker(SETTINGS, np.random.default_rng(0))) as plain:
        plain.walk(Scripted(scripts[0]))
        with pytest.raises(KeyboardInterrupt):
            plain.walk(Interrupted([STILL] * 5))
        expected = Scripted(scripts[1])
        plain.walk(expected)
    assert again.seen == expected.seen


@pytest.mark.parametrize("correction", [np.zeros(3), np.array([np.nan, 0.0])])
def test_a_correction_that_is_none_is_refused_each_time(walker, correction):
    for _ in range(2):
        with pytest.raises(TrajectoryError):
            walker.walk(Scripted([STILL, STILL, correction]))


def test_a_walk_goes_on_after_a_correction_was_refused(walker):
    with pytest.raises(TrajectoryError):
        walker.walk(Scripted([STILL, np.zeros(3)]))
    assert walker.walk(Scripted([STILL] * 5)).completed


def test_a_correction_after_the_end_is_refused(walker):
    class Stubborn(Scripted):
        def respond(self, observation: Observation):
            return BEYOND_REACH

    for _ in range(2):
        with pytest.raises(ValueError, match="the walk is over"):
            walker.walk(Stubborn([]))


def test_a_closed_walker_does_not_even_replay(walker):
    walker.walk(Scripted([STILL] * 3))
    walker.close()
    walker.close()
    with pytest.raises(WorldClosedError):
        walker.walk(Scripted([STILL] * 3))


def test_walks_with_chance_in_them_are_not_replayed():
    disturbed = quick(*SHORT, "sim.disturbances.zmp_noise_m=0.001")
    with pytest.raises(ValueError, match="chance"):
        ReplayingWalker(disturbed, np.random.default_rng(0))


# -- what is computed --------------------------------------------------------------


def test_a_known_walk_is_not_computed(walker):
    script = [LEFT] * 7 + [RIGHT] * 5
    assert [computed_by(walker, script) for _ in range(3)] == [120, 0, 0]
    assert walker.ticks.replayed == 240


def test_the_beginning_of_a_known_walk_is_not_computed(walker):
    walker.walk(Scripted([LEFT] * 12))
    assert computed_by(walker, [LEFT] * 5) == 0


def test_a_known_walk_is_gone_on_with_where_the_robot_stands(walker):
    walker.walk(Scripted([LEFT] * 12))
    assert computed_by(walker, [LEFT] * 15) == 30


def test_a_walk_that_leaves_the_known_ones_executes_again_what_it_must(walker):
    walker.walk(Scripted([STILL] * 20))
    assert computed_by(walker, [STILL] * 10 + [LEFT] * 3) == 100 + 30


def test_the_next_one_that_leaves_them_there_executes_nothing_again(walker):
    walker.walk(Scripted([STILL] * 20))
    walker.walk(Scripted([STILL] * 10 + [LEFT] * 3))
    assert computed_by(walker, [STILL] * 10 + [RIGHT] * 3) == 30


def test_a_long_way_need_not_be_executed_again_from_its_beginning(walker):
    walker.walk(Scripted([STILL] * 60))
    assert computed_by(walker, [STILL] * 50 + [LEFT]) <= 200 + 10


# -- memory ------------------------------------------------------------------------


@settings(deadline=None, max_examples=10)
@given(st.lists(scripts, min_size=1, max_size=6), memories)
def test_the_bound_of_memory_is_kept_between_walks(scripts, memory_bytes):
    walker = ReplayingWalker(SETTINGS, np.random.default_rng(0), memory_bytes)
    with closing(walker):
        for script in scripts:
            walker.walk(Scripted(script))
            assert walker.used_bytes <= max(memory_bytes, NODE_BYTES)


def test_what_was_walked_least_recently_is_forgotten(new_walker):
    walker = new_walker(90 * NODE_BYTES)
    scripts = [[np.array([0.0, y])] * 18 for y in (0.0, 0.001, 0.002, 0.003, 0.004)]
    for script in scripts:
        walker.walk(Scripted(script))
    assert [computed_by(walker, script) for script in scripts[2:]] == [180, 0, 0]


def test_what_is_walked_again_is_not_forgotten(new_walker):
    walker = new_walker(90 * NODE_BYTES)
    scripts = [[np.array([0.0, y])] * 18 for y in (0.0, 0.001, 0.002, 0.003, 0.004)]
    for script in [*scripts[:4], scripts[0], scripts[4]]:
        walker.walk(Scripted(script))
    assert computed_by(walker, scripts[0]) == 0
