"""A memory goes on under other settings where its numbers keep their meaning."""

import pytest
from tests.biped_bringup.runs import SHORT, learn, quick, record

from biped_bringup.memory_settings import _LEARNING, _MADE_BY, _within, with_changes
from biped_bringup.run_settings import RunSettings
from biped_common.settings import SettingsError, dotted, to_mapping

CHANGEABLE = (
    "sim.engine=kinematic",
    "sim.limits.zmp_error_m=0.05",
    "sim.disturbances.push_force_n=20",
    "learner.schedule.successes_per_subtask=4",
    "learner.schedule.extension_s=1.875",
)
OWN = (
    "robot.torso_mass_kg=20",
    "gait.double_support_s=1.2",
    "gait.steps=3",
    "correction.order=4",
    "learner.method=q_lambda",
    "learner.states.life_episodes=5",
    "learner.inputs.waist_radius_m=0.04",
    "learner.action.hold_ticks=5",
    "learner.xol.decomposed=false",
    "learner.cost.tolerance=0.01",
    "learner.rewards.goal=20",
)
PUSHED = "sim.disturbances.push_force_n=10"


# -- what may change ---------------------------------------------------------------


@pytest.mark.parametrize("change", CHANGEABLE)
def test_what_no_number_of_a_memory_tells_of_may_change(change):
    assert with_changes(quick(), None, [change], learns=True) == quick(change)


@pytest.mark.parametrize("change", OWN)
def test_what_a_memory_is_made_by_stays(change):
    key = change.partition("=")[0].replace(".", r"\.")
    with pytest.raises(SettingsError, match=rf"^{key} = .*: must stay .*: its \w+ "):
        with_changes(quick(), None, [change], learns=True)


def test_a_setting_given_as_it_is_is_no_change():
    assert with_changes(quick(), None, ["gait.steps=5"], learns=True) == quick()


def test_a_file_may_change_what_a_set_may(tmp_path):
    file = tmp_path / "pushed.yaml"
    file.write_text("sim: {disturbances: {push_force_n: 10}}\n")
    assert with_changes(quick(), file, [], learns=True) == quick(PUSHED)


def test_a_schedule_is_nothing_to_a_greedy_walk():
    change = "learner.schedule.successes_per_subtask=4"
    with pytest.raises(SettingsError, match="a greedy walk is of the whole walk"):
        with_changes(quick(), None, [change], learns=False)


def test_every_setting_may_change_or_has_a_reason_why_not():
    sections = (*_LEARNING, *_MADE_BY)
    without = [
        key
        for key in dotted(to_mapping(RunSettings()))
        if not any(_within(key, section) for section in sections)
    ]
    assert without == []


# -- a run that goes on under other settings -----------------------------------------


@pytest.fixture
def under(training):
    """Go on with a run under its settings with some changes; it is closed with it."""
    runs = []

    def change(run, *changes):
        settings = with_changes(run.settings, None, changes, learns=True)
        runs.append(run.under(settings))
        return runs[-1]

    yield change
    for run in runs:
        run.close()


def test_it_keeps_memory_log_and_chance(training, under):
    run = learn(training(quick(*SHORT)), 2)
    before, after = record(run), record(under(run, PUSHED))
    assert after.memory_sha256 == before.memory_sha256
    assert after.log_sha256 == before.log_sha256
    assert after.trajectory_sha256 == before.trajectory_sha256
    assert after.progress["rng"] == before.progress["rng"]


def test_what_was_learned_is_to_be_learned_again(training, under):
    run = training(quick(*SHORT))
    run.run(100, False, lambda _: True)
    assert run.learned
    pushed = under(run, PUSHED)
    assert not pushed.learned
    assert pushed.session.task.schedule.complete


def test_its_walks_are_those_of_the_new_settings(training, under):
    run = learn(training(quick(*SHORT)), 1)
    pushed = under(run, "sim.limits.zmp_error_m=0.001")
    assert pushed.episode().end_cause == "zmp_error"


def test_chance_that_comes_in_ends_the_replay(training, under):
    assert under(training(quick(*SHORT)), PUSHED).replay_off is not None


@pytest.mark.parametrize(
    ("change", "target_s"),
    [
        ("learner.schedule.successes_per_subtask=2", 2.82),
        ("learner.schedule.extension_s=0.5", 2.88),
        ("learner.schedule.first_target_s=3.75", 3.75),
    ],
)
def test_it_begins_the_first_subtask_that_is_no_shorter(
    training, under, change, target_s
):
    run = learn(training(quick(*SHORT)), 1)
    assert run.session.task.schedule.target_ticks * 0.002 == pytest.approx(2.82)
    schedule = under(run, change).session.task.schedule
    assert schedule.target_ticks * 0.002 == pytest.approx(target_s)
    assert schedule.successes == 0


def test_it_is_saved_with_its_own_settings(training, under, tmp_path):
    under(training(quick(*SHORT)), PUSHED).save(tmp_path / "memory.npz")
    assert training(tmp_path / "memory.npz").settings == quick(*SHORT, PUSHED)


def test_saved_and_loaded_it_goes_on_bit_for_bit(training, under, tmp_path):
    pushed = under(learn(training(quick(*SHORT)), 2), PUSHED)
    pushed.save(tmp_path / "memory.npz")
    loaded = training(tmp_path / "memory.npz")
    assert record(learn(loaded, 4)) == record(learn(pushed, 4))
