"""The presets beyond the paper, on the physics: they learn, and the same each time.

Seeds here are not those of any result.
"""

from contextlib import closing

import numpy as np
import pytest
from tests.biped_bringup.runs import learn, record

from biped_bringup.run_settings import changed_settings, load_settings
from biped_bringup.walker import Walker
from biped_common.settings import SettingsError
from learner_node.walking.walks import static_walk
from msgs_json.end_cause import EndCause

SEED = 71
SHORT = ("gait.steps=2",)


def uncorrected(settings):
    """Return how the walk without correction ends, its ZMP limit lifted."""
    lifted = changed_settings(settings, changes=["sim.limits.zmp_error_m=1.0"])
    with closing(Walker(lifted, np.random.default_rng(0))) as walker:
        return walker.walk(static_walk(settings.learner, walker.walk_ticks))


def test_the_whole_walk_is_learned_in_few_episodes(training):
    run = training(load_settings("directed"), SEED)
    run.run(max_episodes=60, stop_at_schedule=False, after_episode=lambda _: True)
    assert run.learned
    assert run.greedy_walk().completed


@pytest.mark.thorough
def test_a_walk_that_would_fall_is_learned(training):
    settings = load_settings("t_ds_080")
    assert uncorrected(settings).end_cause is EndCause.FEET_UNLOADED
    run = training(settings, SEED)
    run.run(max_episodes=400, stop_at_schedule=False, after_episode=lambda _: True)
    assert run.learned
    assert run.greedy_walk().completed


@pytest.mark.parametrize("episodes", [2, 5])
def test_a_resumed_run_is_as_if_never_interrupted(
    training, uninterrupted, tmp_path, episodes
):
    settings = load_settings("t_ds_080", changes=SHORT)
    run = learn(training(settings, SEED), episodes)
    run.save(tmp_path / "memory.npz")
    resumed = learn(training(tmp_path / "memory.npz"), 8)
    assert record(resumed) == uninterrupted(settings, SEED).after(8)


def test_replay_changes_nothing(training):
    settings = load_settings("t_ds_080", changes=SHORT)
    replayed = learn(training(settings, SEED), 8)
    computed = learn(training(settings, SEED, replay_bytes=0), 8)
    assert replayed.walker.ticks.replayed > 0
    assert record(replayed) == record(computed)


def test_blame_is_directed_by_the_spline_that_there_is():
    with pytest.raises(SettingsError) as refusal:
        load_settings("directed", changes=["correction.knot_spacing_s=0.3"])
    assert str(refusal.value) == (
        "learner.blame.knot_spacing_s = 0.4: must be correction.knot_spacing_s = 0.3 "
        "where blame is directed"
    )


def test_joint_rules_have_no_order_to_be_judged_by():
    with pytest.raises(SettingsError, match=r"learner\.blame\.directed = True"):
        load_settings("directed", changes=["learner.xol.decomposed=false"])
