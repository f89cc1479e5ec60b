"""Learning as a whole: it learns, and whatever happens, it happens the same again."""

from pathlib import Path

import numpy as np
import pytest
from tests.biped_bringup.runs import DISTURBED, SHORT, learn, quick, record
from tests.thorough import first_always

from biped_bringup.run_settings import load_settings
from msgs_json.episode_result import EpisodeResult

EPISODES = 30  # enough that penalties, releases and both supports are met
SHORT_EPISODES = 5


def go_on(_: EpisodeResult) -> bool:
    return True


# -- outcome -----------------------------------------------------------------------


def test_a_short_walk_is_learned(training, biped):
    changes = ("gait.steps=2", "learner.schedule.successes_per_subtask=2")
    static = biped("walk", "--static", "--set", changes[0])
    assert static.status == 1, "a walk that needs no learning proves nothing"
    run = training(load_settings("coarse", None, changes))
    run.run(max_episodes=300, stop_at_schedule=False, after_episode=go_on)
    assert run.learned
    assert run.greedy_walk().completed


# -- same seed, same run -----------------------------------------------------------


def test_the_same_seed_gives_the_same_run(training, uninterrupted):
    run = learn(training(quick(), seed=0), EPISODES)
    assert record(run) == uninterrupted(quick(), 0).after(EPISODES)


def test_another_seed_gives_another_memory(uninterrupted):
    one, other = (uninterrupted(quick(), seed).after(3) for seed in (0, 1))
    assert one.memory_sha256 != other.memory_sha256


def test_another_seed_gives_other_trajectories(uninterrupted):
    one, other = (uninterrupted(quick(), seed).after(3) for seed in (0, 1))
    assert one.trajectory_sha256 != other.trajectory_sha256


def test_disturbances_are_felt(uninterrupted):
    calm = uninterrupted(quick(*SHORT)).after(1)
    disturbed = uninterrupted(quick(*SHORT, *DISTURBED)).after(1)
    assert calm.trajectory_sha256 != disturbed.trajectory_sha256


def test_two_runs_in_turn_are_as_if_each_were_alone(training, uninterrupted):
    runs = [training(quick(), seed) for seed in (0, 1)]
    for _ in range(5):
        for run in runs:
            run.episode()
    alone = [uninterrupted(quick(), seed).after(5) for seed in (0, 1)]
    assert [record(run) for run in runs] == alone


def test_a_run_with_a_memory_of_its_own_does_not_touch_another(training):
    one, other = training(quick(*SHORT), 0), training(quick(*SHORT), 1)
    before = record(other)
    learn(one, 2)
    assert record(other) == before


# -- checkpoints -------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [(), DISTURBED, ("learner.method=q_lambda",)],
    ids=["calm", "disturbed", "q_lambda"],
)
@pytest.mark.parametrize("saved_after", first_always([3, 1]))
def test_a_resumed_run_is_as_if_never_interrupted(
    training, uninterrupted, tmp_path, saved_after, changes
):
    settings = quick(*SHORT, *changes)
    learn(training(settings), saved_after).save(tmp_path / "memory.npz")
    resumed = learn(training(tmp_path / "memory.npz"), SHORT_EPISODES)
    assert record(resumed) == uninterrupted(settings).after(SHORT_EPISODES)


def test_the_resumed_runs_above_cross_a_step_of_the_schedule(uninterrupted):
    short = uninterrupted(quick(*SHORT))
    short.after(SHORT_EPISODES)
    targets = short.run.log.arrays()["target_ticks"][1:SHORT_EPISODES]
    assert len(set(targets.tolist())) > 1


def test_a_resumed_run_goes_on_through_failures(training, uninterrupted, tmp_path):
    learn(training(quick()), 4).save(tmp_path / "memory.npz")
    resumed = learn(training(tmp_path / "memory.npz"), 12)
    assert 0.0 in resumed.log.arrays()["reward"][4:]
    assert record(resumed) == uninterrupted(quick()).after(12)


def test_saving_after_every_episode_changes_nothing(training, uninterrupted, tmp_path):
    run = training(quick(*SHORT))
    for episodes in range(1, SHORT_EPISODES + 1):
        learn(run, episodes).save(tmp_path / "memory.npz")
    assert record(run) == uninterrupted(quick(*SHORT)).after(SHORT_EPISODES)


def test_a_loaded_run_has_the_record_of_the_saved_one(training, tmp_path):
    saved = learn(training(quick(*SHORT, *DISTURBED)), 3)
    saved.save(tmp_path / "memory.npz")
    assert record(training(tmp_path / "memory.npz")) == record(saved)


def test_a_loaded_run_has_the_settings_of_the_saved_one(training, tmp_path):
    settings = quick(*SHORT, *DISTURBED)
    training(settings).save(tmp_path / "memory.npz")
    assert training(tmp_path / "memory.npz").settings == settings


def test_a_loaded_run_has_the_seed_of_the_saved_one(training, tmp_path):
    training(quick(*SHORT), seed=5).save(tmp_path / "memory.npz")
    assert training(tmp_path / "memory.npz").seed == 5


def test_a_resumed_run_counts_its_computing_time_on(training, tmp_path):
    saved = learn(training(quick(*SHORT)), 2)
    saved.save(tmp_path / "memory.npz")
    resumed = learn(training(tmp_path / "memory.npz"), 3)
    assert resumed.cpu_s > saved.cpu_s > 0.0


def test_a_run_that_is_not_saved_leaves_no_file(training, tmp_path):
    learn(training(quick(*SHORT)), 1)
    assert list(tmp_path.iterdir()) == []


# -- the frozen greedy walk --------------------------------------------------------


def test_a_greedy_walk_changes_nothing_that_was_learned(training):
    run = learn(training(quick()), 3)
    before = record(run)
    run.greedy_walk()
    assert record(run) == before


def test_a_greedy_walk_is_the_same_each_time(training):
    run = learn(training(quick()), 3)
    walks = [run.greedy_walk().trajectory_sha256 for _ in range(2)]
    assert walks[0] == walks[1]


def test_a_greedy_walk_in_between_does_not_change_what_is_learned_next(
    training, uninterrupted
):
    run = learn(training(quick()), 3)
    run.greedy_walk()
    assert record(learn(run, 5)) == uninterrupted(quick()).after(5)


def test_a_greedy_walk_is_of_the_whole_walk(training):
    run = training(quick())
    assert run.greedy_walk().target_ticks == run.walker.walk_ticks


def test_learning_and_trial_walks_are_counted_apart(training):
    run = training(quick(*SHORT))
    run.run(max_episodes=100, stop_at_schedule=False, after_episode=go_on)
    assert run.tally.evaluations > 0
    walked = run.log.arrays()["control_ticks"].sum()
    assert run.tally.simulated_ticks == walked


# -- when a run ends ---------------------------------------------------------------


def test_a_run_ends_when_the_walk_is_learned(training):
    run = training(quick(*SHORT))
    run.run(max_episodes=100, stop_at_schedule=False, after_episode=go_on)
    assert run.tally.greedy_episodes == run.episodes


def test_a_run_can_end_with_the_schedule(training):
    run = training(quick(*SHORT))
    run.run(max_episodes=100, stop_at_schedule=True, after_episode=go_on)
    assert run.tally.schedule_episodes == run.episodes


def test_a_run_ends_after_the_last_episode_allowed(training):
    run = training(quick())
    run.run(max_episodes=2, stop_at_schedule=False, after_episode=go_on)
    assert run.episodes == 2


def test_a_run_ends_when_told_to(training):
    run = training(quick())
    run.run(None, False, after_episode=lambda _: run.episodes < 2)
    assert run.episodes == 2


def test_a_learned_run_does_not_go_on(training):
    run = training(quick(*SHORT))
    run.run(max_episodes=100, stop_at_schedule=False, after_episode=go_on)
    episodes = run.episodes
    run.run(max_episodes=100, stop_at_schedule=False, after_episode=go_on)
    assert run.episodes == episodes


# -- figures -----------------------------------------------------------------------


def test_the_summary_tells_where_the_run_stands(training):
    run = learn(training(quick(*SHORT), seed=4), 1)
    summary = run.summary(Path("memory.npz"))
    log = run.log.arrays()
    assert summary["seed"] == 4
    assert summary["episodes"] == 1
    assert summary["simulated_s"] == pytest.approx(0.002 * log["control_ticks"][0])
    assert summary["figures"] == run.session.learner.figures()
    assert summary["memory_sha256"] == run.session.memory_sha256()
    assert summary["memory_file"] == "memory.npz"


def test_the_summary_of_an_unfinished_run_leaves_open_when_it_learned(training):
    summary = training(quick(*SHORT)).summary(Path("memory.npz"))
    assert summary["schedule_episodes"] is None
    assert summary["greedy_episodes"] is None
    assert not summary["completed"]


def test_the_memory_is_nothing_but_numbers(training, tmp_path):
    learn(training(quick(*SHORT)), 1).save(tmp_path / "memory.npz")
    with np.load(tmp_path / "memory.npz", allow_pickle=False) as file:
        kinds = {name: file[name].dtype.kind for name in file.files}
    assert kinds.pop("header") == "U"
    assert set(kinds.values()) <= set("ifb")
