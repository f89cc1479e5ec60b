"""Learning with replay: the same run, computed for a small part only."""

import re
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import pytest
from tests.biped_bringup.runs import DISTURBED, SHORT, Record, learn, quick, record
from tests.thorough import first_always

from biped_bringup.replay import ReplayingWalker
from biped_bringup.run_settings import RunSettings, load_settings
from biped_bringup.training import TrainingRun
from learner_node.checkpoint import read_checkpoint

EPISODES, SAVED_AFTER = 40, 20
_PRACTICE = ("gait.steps=1", "learner.schedule.successes_per_subtask=3")
_FIXED = "learner.xol.fixed_mode"
SETTINGS = {
    "K = 5": load_settings("paper", None, (*_PRACTICE, f"{_FIXED}.rewards_to_fix=5")),
    "K = 1": load_settings("paper", None, (*_PRACTICE, f"{_FIXED}.rewards_to_fix=1")),
    "no fixed mode": load_settings(
        "paper", None, (*_PRACTICE, f"{_FIXED}.strategy=none")
    ),
}
# Long enough that states become fixed and walks repeat.
LEARN = ("learn", "--json", "--preset", "quick", "--set", SHORT[0], "--episodes", "20")


@dataclass(frozen=True)
class Learned:
    """One run, computed from end to end, and replayed."""

    settings: RunSettings
    computed: Record
    replayed: Record
    replayed_ticks: int
    checkpoint: Path
    """Of the replayed run, in its middle."""


@pytest.fixture(
    scope="module",
    params=first_always(SETTINGS),
)
def learned(request, tmp_path_factory) -> Learned:
    settings = SETTINGS[request.param]
    checkpoint = tmp_path_factory.mktemp("replay") / "memory.npz"
    with closing(TrainingRun(settings, seed=1, replay_bytes=0)) as run:
        computed = record(learn(run, EPISODES))
    with closing(TrainingRun(settings, seed=1)) as run:
        learn(run, SAVED_AFTER).save(checkpoint)
        replayed = record(learn(run, EPISODES))
        ticks = run.walker.ticks.replayed
    return Learned(settings, computed, replayed, ticks, checkpoint)


# -- the same run ------------------------------------------------------------------


def test_a_replayed_run_learns_the_same(learned):
    assert learned.replayed == learned.computed


def test_the_runs_that_learn_the_same_do_replay(learned):
    assert learned.replayed_ticks > 0


def test_a_replayed_run_that_is_resumed_learns_the_same(learned, training):
    resumed = learn(training(learned.checkpoint), EPISODES)
    assert record(resumed) == learned.computed


@pytest.mark.thorough
def test_a_replayed_run_that_is_resumed_without_replay_learns_the_same(learned):
    with closing(TrainingRun.load(learned.checkpoint, replay_bytes=0)) as resumed:
        assert record(learn(resumed, EPISODES)) == learned.computed


@pytest.mark.thorough
def test_a_run_that_forgets_its_walks_learns_the_same(learned):
    run = TrainingRun(learned.settings, seed=1, replay_bytes=500_000)
    with closing(run):
        assert record(learn(run, EPISODES)) == learned.computed


@pytest.mark.thorough
def test_a_checkpoint_does_not_tell_whether_walks_were_replayed(training, tmp_path):
    headers, contents = [], []
    for replay_bytes in (0, 500_000_000):
        with closing(TrainingRun(quick(*SHORT), 0, replay_bytes)) as run:
            learn(run, 6).save(tmp_path / "memory.npz")
        header, arrays = read_checkpoint(tmp_path / "memory.npz")
        for effort in ("cpu_s", "walked_ticks"):
            del header[effort]
        headers.append(header)
        contents.append(arrays.keys())
    assert headers[0] == headers[1]
    assert contents[0] == contents[1]


def test_greedy_trials_are_replayed(training):
    run = learn(training(quick(*SHORT)), 3)
    first = run.greedy_walk()
    computed = run.walker.ticks.computed
    again = run.greedy_walk()
    assert run.walker.ticks.computed == computed
    assert again.trajectory_sha256 == first.trajectory_sha256


# -- on and off --------------------------------------------------------------------


def test_chance_in_the_walks_switches_replay_off(training):
    run = learn(training(quick(*SHORT, *DISTURBED)), 2)
    assert "random disturbances" in run.replay_off
    assert run.walker.ticks.replayed == 0


def test_another_robot_without_chance_is_replayed(training):
    settings = quick(*SHORT, "sim.disturbances.friction=0.8")
    assert isinstance(training(settings).walker, ReplayingWalker)


@pytest.mark.thorough
def test_replay_can_be_switched_off(biped):
    replayed = biped(*LEARN).values
    computed = biped(*LEARN, "--fresh", "--no-replay").values
    assert (replayed["replay_off"], computed["replay_off"]) == (None, "as asked")
    assert replayed["replayed_ticks"] > computed["replayed_ticks"] == 0
    for same in ("memory_sha256", "trajectory_sha256", "simulated_s"):
        assert replayed[same] == computed[same]


def test_a_report_says_that_walks_were_replayed(biped):
    words = [word for word in LEARN if word != "--json"]
    assert re.search(
        r"replay +[\d,]+ control ticks, [\d,]+ computed", biped(*words).out
    )


@pytest.mark.thorough
def test_a_report_says_why_no_walk_was_replayed(biped):
    words = [word for word in LEARN if word != "--json"]
    out = biped(*words, "--set", DISTURBED[0]).out
    assert "replay               off: random disturbances" in out


# -- counts ------------------------------------------------------------------------


@pytest.mark.thorough
def test_without_replay_all_that_was_walked_was_computed(biped):
    values = biped(*LEARN, "--no-replay").values
    walked_s = values["simulated_s"] + values["evaluation_s"]
    assert values["computed_ticks"] * 0.002 == pytest.approx(walked_s)


def test_what_was_not_computed_was_replayed(biped):
    values = biped(*LEARN).values
    walked = round((values["simulated_s"] + values["evaluation_s"]) / 0.002)
    assert values["computed_ticks"] < walked
    # Some was executed again, to put the robot where a walk had come to.
    assert values["computed_ticks"] + values["replayed_ticks"] >= walked


def test_a_resumed_run_counts_its_ticks_on(training, tmp_path):
    saved = learn(training(quick(*SHORT)), 3)
    saved.save(tmp_path / "memory.npz")
    resumed = training(tmp_path / "memory.npz")
    assert resumed.walker.ticks == saved.walker.ticks
    learn(resumed, 5)
    assert resumed.walker.ticks.computed > saved.walker.ticks.computed
