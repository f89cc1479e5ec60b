"""The linear program: its model is the plant's, and its plan walks."""

from contextlib import closing

import numpy as np
import pytest

from biped_bringup.run_settings import load_settings
from biped_bringup.walker import Walker
from biped_lab.searches.linear_programming import (
    difficulty,
    static_zmp_error,
    zmp_response,
)
from biped_lab.searches.plan import COMPONENTS, PlanSpace
from learner_node.walking.walks import FrozenWalk

STEP = ("gait.steps=1", "sim.limits.zmp_error_m=1.0")


def test_the_paper_walk_can_be_held_far_within_the_limit():
    row = difficulty(double_support_s=1.05, knot_spacing_s=0.4)
    assert row.tick_m == pytest.approx(0.024, abs=0.001)
    assert row.tick_m < row.knot_m < 0.6 * row.static_m
    assert row.end_cause == "completed"
    assert row.peak_m < 0.065


@pytest.mark.parametrize("engine", ["kinematic", "pybullet"])
def test_the_linear_model_foretells_the_zmp_of_a_corrected_walk(engine):
    settings = load_settings(changes=(*STEP, f"sim.engine={engine}"))
    space = PlanSpace.of_knots(settings)
    plan_m = space.random(np.random.default_rng(1), space.points) / 4.0
    ticks = []
    walker = Walker(settings, np.random.default_rng(0), ticks.append)
    corrected = FrozenWalk(
        settings.learner,
        walker.walk_ticks,
        lambda seen: plan_m[space.point_at(seen.control_tick)],
    )
    with closing(walker):
        walker.walk(corrected)
    error_m = np.array([tick.contact[:2] for tick in ticks]) - np.array(
        [tick.zmp_reference for tick in ticks]
    )
    static_m = static_zmp_error(settings)
    foretold_m = static_m + zmp_response(settings, space) @ plan_m
    left_m = np.abs(error_m - foretold_m)
    moved_m = np.abs(foretold_m - static_m).max(axis=0)
    assert foretold_m.shape == (walker.walk_ticks, COMPONENTS)
    assert (np.percentile(left_m, 95.0, axis=0) < 0.2 * moved_m).all()


def test_a_held_decision_is_a_longer_correction():
    held = load_settings(changes=(*STEP, "learner.action.hold_ticks=5"))
    each_tick = zmp_response(held, PlanSpace.of_learning_ticks(held))
    assert (np.abs(each_tick).max(axis=0) > 0.0).sum() == -(-188 // 5)
