"""Plans: their points in time, and their rounding to the alternatives."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from biped_bringup.run_settings import load_settings
from biped_lab.searches.plan import PlanSpace
from learner_node.walking.task import WalkTask
from trajectory_node.settings import CorrectionSettings, GaitSettings

PAPER = load_settings()
corrections = st.lists(st.floats(-0.05, 0.05), min_size=1, max_size=20).map(np.array)
spaces = st.builds(
    PlanSpace,
    points=st.just(1),
    spacing_us=st.just(400_000),
    limit_m=st.floats(0.001, 0.2),
    alternatives=st.integers(2, 40),
)


@given(spaces, corrections)
def test_no_alternative_is_nearer_than_the_one_rounded_to(space, plan_m):
    all_m = space.corrections_m(np.arange(space.alternatives))
    chosen = space.nearest(plan_m)
    off_m = np.abs(all_m[:, None] - plan_m)
    rounded = np.abs(all_m[chosen] - plan_m)
    assert np.allclose(rounded, off_m.min(axis=0), rtol=0.0, atol=1e-12)


@given(spaces)
def test_alternatives_are_rounded_to_themselves(space):
    chosen = np.arange(space.alternatives)
    assert np.array_equal(space.nearest(space.corrections_m(chosen)), chosen)


def test_alternatives_are_those_of_the_task():
    task = WalkTask(PAPER.learner, PAPER.gait.walk_ticks)
    space, chosen = PlanSpace.of_knots(PAPER), np.array([3, 11])
    assert np.array_equal(space.corrections_m(chosen), task.correction_m(chosen))


@given(st.floats(0.2, 2.0), st.integers(1, 5))
def test_every_decision_has_a_point_and_the_last_point_a_decision(knot_s, steps):
    settings = replace(
        PAPER,
        gait=GaitSettings(steps=steps),
        correction=CorrectionSettings(knot_spacing_s=knot_s),
    )
    space = PlanSpace.of_knots(settings)
    decisions = range(0, settings.gait.walk_ticks, 10)
    taken = [space.point_at(tick) for tick in decisions]
    assert sorted({*taken}) == list(range(space.points))
    assert space.points_until(settings.gait.walk_ticks) == space.points


def test_a_point_lasts_for_a_knot_spacing():
    space = PlanSpace.of_knots(PAPER)
    assert [space.point_at(tick) for tick in (0, 199, 200, 399, 400)] == [0, 0, 1, 1, 2]
    assert [space.points_until(ticks) for ticks in (1, 200, 201, 211)] == [1, 1, 2, 2]
