"""Searching contestants on the robot: a short walk, and all that is kept of it."""

from collections.abc import Iterator
from contextlib import ExitStack, closing

import gymnasium
import numpy as np
import pytest

from biped_bringup.run_settings import load_settings
from biped_common.settings import SettingsError
from biped_common.timing import seconds
from biped_lab.contestant import MILESTONES, entry
from biped_lab.searches.plan import PlanSpace
from learner_node.checkpoint import CheckpointError, read_checkpoint

# Two steps, on which the walk fails without corrections.
HARD = ("gait.steps=2", "gait.double_support_s=1.0")
SETTINGS = load_settings(changes=HARD)
WALK_TICKS = SETTINGS.gait.walk_ticks
# Small populations: their ends lie on either side of the interruption, too.
SMALL = {
    "tail_search": {},
    "cma_es": {"population": 3},
    "cma_es_incremental": {"population": 3},
    "genetic": {"population": 3},
    "linear_programming": {},
}


def options_of(name):
    """Return the options of a contestant."""
    return entry(name).options(**SMALL[name])


@pytest.fixture
def begin() -> Iterator:
    """Begin contestants that are closed when the test is over."""
    with ExitStack() as stack:

        def begin(name, seed=1, settings=SETTINGS):
            made = entry(name).begin(settings, options_of(name), seed)
            return stack.enter_context(closing(made))

        yield begin


def walk(contestant, episodes):
    """Walk so many episodes."""
    for _ in range(episodes):
        contestant.episode()
    return contestant


def test_tail_search_walks_two_hard_steps_within_twenty_episodes(begin):
    contestant = begin("tail_search", seed=2101)
    while contestant.milestone("greedy") is None:
        assert contestant.episodes < 20
        contestant.episode()
    assert {contestant.milestone(name) for name in MILESTONES} == {contestant.episodes}
    table = contestant.table()
    assert table["end_cause"][-1] == "completed"
    assert table["control_ticks"][-1] == WALK_TICKS
    assert (table["control_ticks"][:-1] < WALK_TICKS).all()
    walked = contestant.ticks.computed + contestant.ticks.replayed
    assert walked >= contestant.figures()["simulated_ticks"] > contestant.ticks.computed


@pytest.mark.parametrize("name", SMALL)
@pytest.mark.thorough
def test_a_resumed_search_is_the_uninterrupted_one(begin, tmp_path, name):
    whole, first = walk(begin(name), 7), walk(begin(name), 4)
    file = tmp_path / "search.npz"
    first.save(file)
    with closing(entry(name).resume(file, SETTINGS, options_of(name), 1)) as resumed:
        assert resumed.episodes == 4
        walk(resumed, 3)
        assert resumed.figures() == whole.figures()
        assert resumed.cpu_s > first.cpu_s
        for column, values in whole.table().items():
            assert np.array_equal(values, resumed.table()[column])


def test_another_seed_is_another_search(begin):
    one, other = (walk(begin("tail_search", seed), 2) for seed in (1, 2))
    assert one.figures()["memory_sha256"] != other.figures()["memory_sha256"]


@pytest.mark.parametrize(
    ("seed", "settings", "says"),
    [
        (2, SETTINGS, "episode 2 has another plan"),
        (1, load_settings(changes=("gait.steps=1",)), "other settings"),
    ],
)
def test_the_history_of_another_search_is_refused(
    begin, tmp_path, seed, settings, says
):
    file = tmp_path / "search.npz"
    walk(begin("tail_search"), 2).save(file)
    with pytest.raises(CheckpointError, match=says):
        entry("tail_search").resume(file, settings, options_of("tail_search"), seed)


def test_the_horizon_grows_when_it_is_walked(begin):
    easy = load_settings(changes=("gait.steps=1", "sim.limits.zmp_error_m=0.3"))
    contestant = walk(begin("cma_es_incremental", settings=easy), 3)
    assert contestant.table()["target_ticks"].tolist() == [940, 1410, 1875]
    assert contestant.milestone("schedule") == 3


def test_random_disturbances_are_refused(begin):
    noisy = load_settings(changes=("sim.disturbances.zmp_noise_m=0.001",))
    with pytest.raises(SettingsError, match=r"^sim\.disturbances = .*: must not be"):
        begin("tail_search", settings=noisy)


@pytest.mark.parametrize("hold_ticks", [1, 5])
def test_plans_walk_the_same_walks_through_gymnasium(begin, tmp_path, hold_ticks):
    changes = {"gait": {"steps": 2}, "learner": {"action": {"hold_ticks": hold_ticks}}}
    env = gymnasium.make("biped_lab:BipedWaist-v0", settings=changes)
    settings = env.unwrapped.settings
    contestant = walk(begin("genetic", settings=settings), 3)
    contestant.save(tmp_path / "search.npz")
    _, arrays = read_checkpoint(tmp_path / "search.npz")
    space = PlanSpace.of_knots(settings)
    with closing(env):
        for episode, plan in enumerate(arrays["plans"]):
            row = {name: column[episode] for name, column in contestant.table().items()}
            info = walk_in(env, plan, space, 10 * hold_ticks)
            assert info["walked_s"] == seconds(row["control_ticks"])
            assert info["end_cause"] == row["end_cause"]
            assert info["t_err"] == row["t_err"]  # to the last bit


def walk_in(env, plan, space, decision_ticks):
    """Walk (points, 2) alternatives in an environment; return the last info."""
    env.reset()
    for tick in range(0, WALK_TICKS, decision_ticks):
        *_, terminated, truncated, info = env.step(plan[space.point_at(tick)])
        if terminated or truncated:
            return info
    raise AssertionError("a walk without end")
