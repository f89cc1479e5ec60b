"""`BipedWaist-v0`: the paper's task as Gymnasium's users meet it."""

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from biped_bringup.run_settings import load_settings
from biped_bringup.training import TrainingRun
from biped_common.seeds import learner_stream
from biped_common.settings import SettingsError
from biped_lab.gym_learning import GymTask, practise
from learner_node.memory import arrays_sha256
from learner_node.methods import make_learner

ID = "biped_lab:BipedWaist-v0"
MIDDLE = np.array([7, 7])
SEED = 5
STATIC_FAILS_AT_S = 2.262


@pytest.fixture
def make():
    made = []

    def make(**options):
        made.append(gymnasium.make(ID, **options))
        return made[-1]

    yield make
    for env in made:
        env.close()


def walk(env, action=MIDDLE, seed=None):
    """Walk with one action to the end; return (observations, the last step)."""
    observation, _ = env.reset(seed=seed)
    observations = [observation]
    while True:
        step = env.step(action)
        observations.append(step[0])
        if step[2] or step[3]:
            return np.array(observations), step


@pytest.mark.parametrize("render_mode", [None, "rgb_array"])
def test_gymnasium_has_nothing_to_find_fault_with(make, render_mode):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(make(render_mode=render_mode).unwrapped)


def test_without_correction_the_walk_fails_by_its_zmp(make):
    _, (_, reward, terminated, truncated, info) = walk(make())
    assert (reward, terminated, truncated) == (0.0, True, False)
    assert info["end_cause"] == "zmp_error"
    assert info["penalty"] == 0
    assert info["walked_s"] == pytest.approx(STATIC_FAILS_AT_S)


def test_with_the_limit_lifted_the_whole_walk_is_rewarded(make):
    settings = {"sim": {"limits": {"zmp_error_m": 1.0}}}
    _, (_, reward, terminated, _, info) = walk(make(settings=settings))
    assert (reward, terminated) == (10_000.0, True)
    assert info["walked_s"] == 11.25
    assert "penalty" not in info
    assert 0.0 < info["t_err"] < 10.0


def test_a_walk_without_disturbances_repeats_itself(make):
    env = make()
    (first, _), (second, _) = walk(env), walk(env)
    assert np.array_equal(first, second)


def test_a_seed_repeats_disturbances_and_another_does_not(make):
    env = make(settings={"sim": {"disturbances": {"zmp_noise_m": 0.001}}})
    first, again, other = (walk(env, seed=seed)[0] for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first[:20], other[:20])


def test_a_decision_is_held_as_the_settings_say(make):
    env = make(preset="coarse")
    _, (*_, info) = walk(env)
    observations, _ = walk(env)
    assert len(observations) - 1 == int(np.ceil(info["walked_s"] / 0.1))


def test_a_schedule_begins_with_a_short_walk(make):
    whole, scheduled = make().unwrapped.task, make(schedule=True).unwrapped.task
    assert whole.schedule.targets == (5625,)
    assert scheduled.schedule.targets[0] == 940
    assert len(scheduled.schedule.targets) == 11


def test_an_episode_ends_where_it_has_succeeded(make):
    env = make(preset="directed", schedule=True)
    _, step = walk(env)
    assert (step[1], step[2]) == (10_000.0, True)
    assert step[4]["walked_s"] == 0.94
    assert step[4]["outcome"].ended


def test_a_wrong_setting_is_refused_by_name(make):
    with pytest.raises(SettingsError, match=r"gait\.steps = 0: must be between"):
        make(settings={"gait": {"steps": 0}})


def test_after_its_end_a_walk_must_be_begun_anew(make):
    env = make().unwrapped
    walk(env)
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(MIDDLE)


def test_the_picture_shows_that_the_robot_has_moved(make):
    env = make(render_mode="rgb_array")
    env.reset()
    before = env.render()
    for _ in range(60):
        env.step(MIDDLE)
    assert before.shape == env.render().shape
    assert (before != env.render()).any(axis=2).sum() > 500


def test_learning_through_gymnasium_is_learning_bit_for_bit(make):
    settings = load_settings("quick")
    env = make(preset="quick", schedule=True)
    radii = settings.learner.inputs.radii
    task = GymTask(env, radii=radii, penalty_values=(10.0, 10.0, 10.0))
    rng = np.random.default_rng(learner_stream(SEED))
    learner = make_learner(settings.learner, task.problem, rng)
    run = TrainingRun(settings, SEED)
    for _ in range(15):
        practise(task, learner)
        run.episode()
    run.close()
    assert arrays_sha256(learner.memory()) == run.session.memory_sha256()
