"""The planned walk: feet, support flags and reference ZMP."""

import numpy as np
import pytest
from tests.robots import SHIPPED

from trajectory_node.gait import GaitPlan, plan_gait, quintic, swing_bump
from trajectory_node.settings import GaitSettings

HALF_SPACING = SHIPPED.settings.half_hip_spacing_m
AHEAD = SHIPPED.settings.sole_ahead_of_ankle_m

GAITS = [GaitSettings(steps=steps) for steps in range(1, 9)]
GAITS += [
    GaitSettings(step_period_s=step, double_support_s=double)
    for step, double in [(1.875, 0.9), (1.0, 0.5), (1.3333, 0.7001), (2.5, 1.9)]
]
EVERY_GAIT = pytest.mark.parametrize(
    "gait",
    GAITS,
    ids=[f"{g.steps}x{g.step_period_s}s-{g.double_support_s}s" for g in GAITS],
)


@pytest.fixture(scope="module")
def plan() -> GaitPlan:
    """Plan the default walk."""
    return plan_of(GaitSettings())


def plan_of(gait: GaitSettings) -> GaitPlan:
    return plan_gait(gait, SHIPPED.settings)


def single_supports(plan: GaitPlan) -> list[slice]:
    """Return the rows of each single support, first to last."""
    edges = np.flatnonzero(np.diff(plan.double_support.astype(int))) + 1
    return [slice(a, b) for a, b in edges.reshape(-1, 2)]


def swing_and_stance(plan: GaitPlan, rows: slice) -> tuple[np.ndarray, np.ndarray]:
    """Return the swing and the stance foot (n, 3) of a single support."""
    feet = plan.right_foot[rows], plan.left_foot[rows]
    return feet[::-1] if plan.right_support[rows.start] else feet


def is_constant(flags: np.ndarray) -> bool:
    """Whether all flags are the same, of which there is at least one."""
    return bool((flags == flags[0]).all())


def stance_sole_centre(plan: GaitPlan, tick: int) -> np.ndarray:
    """Return the centre (x, y) of the sole that the support flag names."""
    foot = (plan.right_foot if plan.right_support[tick] else plan.left_foot)[tick]
    return np.add(foot[:2], (AHEAD, 0.0))


def test_the_walk_has_5625_control_ticks(plan):
    assert plan.ticks == 5625


@EVERY_GAIT
def test_the_walk_lasts_one_step_period_more_than_its_steps(gait):
    assert plan_of(gait).ticks == int((gait.steps + 1) * gait.step_period_s / 0.002)


@EVERY_GAIT
def test_there_are_as_many_single_supports_as_steps(gait):
    assert len(single_supports(plan_of(gait))) == gait.steps


@EVERY_GAIT
def test_a_single_support_lasts_what_the_double_support_leaves(gait):
    lengths = [0.002 * (s.stop - s.start) for s in single_supports(plan_of(gait))]
    np.testing.assert_allclose(lengths, gait.single_support_s, rtol=0, atol=0.002)


@EVERY_GAIT
def test_steps_begin_one_step_period_apart(gait):
    starts = np.array([s.start * 0.002 for s in single_supports(plan_of(gait))])
    first = gait.stand_s + gait.double_support_s
    expected = first + gait.step_period_s * np.arange(gait.steps)
    np.testing.assert_allclose(starts, expected, rtol=0, atol=0.002)


@EVERY_GAIT
def test_the_right_foot_swings_first_and_then_the_feet_take_turns(gait):
    plan = plan_of(gait)
    stance_is_right = [plan.right_support[s.start] for s in single_supports(plan)]
    assert stance_is_right == [step % 2 == 1 for step in range(gait.steps)]


@EVERY_GAIT
def test_the_support_leg_stays_the_same_throughout_a_single_support(gait):
    plan = plan_of(gait)
    assert all(is_constant(plan.right_support[s]) for s in single_supports(plan))


@EVERY_GAIT
def test_the_foot_that_carries_the_robot_stands_still(gait):
    plan = plan_of(gait)
    stances = [swing_and_stance(plan, rows)[1] for rows in single_supports(plan)]
    assert max(np.ptp(stance, axis=0).max() for stance in stances) == 0.0


@EVERY_GAIT
def test_both_feet_stand_still_on_the_floor_in_double_support(gait):
    plan = plan_of(gait)
    together = plan.double_support[1:] & plan.double_support[:-1]
    moved = [np.abs(np.diff(f, axis=0)) for f in (plan.left_foot, plan.right_foot)]
    heights = [f[plan.double_support, 2] for f in (plan.left_foot, plan.right_foot)]
    assert np.max([m[together] for m in moved]) == np.max(heights) == 0.0


@EVERY_GAIT
def test_the_swing_foot_rises_to_the_swing_height(gait):
    plan = plan_of(gait)
    tops = [swing_and_stance(plan, s)[0][:, 2].max() for s in single_supports(plan)]
    np.testing.assert_allclose(tops, gait.swing_height_m, rtol=0, atol=1e-5)


@EVERY_GAIT
def test_no_foot_goes_through_the_floor(gait):
    plan = plan_of(gait)
    assert min(plan.left_foot[:, 2].min(), plan.right_foot[:, 2].min()) == 0.0


def test_each_foot_lands_one_step_length_ahead_of_the_other(plan):
    landings = [
        (plan.left_foot if plan.right_support[s.start] else plan.right_foot)[s.stop, 0]
        for s in single_supports(plan)
    ]
    np.testing.assert_allclose(landings, [0.1, 0.2, 0.3, 0.4, 0.4], atol=1e-12)


@pytest.mark.parametrize("steps", range(2, 9))
def test_the_last_step_closes_the_feet(steps):
    plan = plan_of(GaitSettings(steps=steps))
    expected = [(steps - 1) * 0.1, HALF_SPACING, 0.0]
    feet = plan.left_foot[-1], plan.right_foot[-1] * (1.0, -1.0, 1.0)
    np.testing.assert_allclose(feet, [expected, expected], rtol=0, atol=1e-12)


@EVERY_GAIT
def test_the_feet_keep_to_their_sides(gait):
    plan = plan_of(gait)
    sides = np.stack([plan.left_foot[:, 1], -plan.right_foot[:, 1]])
    np.testing.assert_array_equal(sides, HALF_SPACING)


def test_the_robot_can_walk_backwards():
    plan = plan_of(GaitSettings(step_length_m=-0.1))
    assert plan.right_foot[-1, 0] == pytest.approx(-0.4, abs=1e-12)


def test_the_robot_can_march_on_the_spot():
    plan = plan_of(GaitSettings(step_length_m=0.0))
    assert not plan.right_foot[:, 0].any()


@EVERY_GAIT
def test_a_double_support_already_names_the_coming_stance_leg(gait):
    plan = plan_of(gait)
    began = 0
    for rows in single_supports(plan):
        assert is_constant(plan.right_support[began : rows.stop])
        began = rows.stop


@EVERY_GAIT
def test_after_the_last_step_the_support_flag_stays(gait):
    plan = plan_of(gait)
    last = single_supports(plan)[-1]
    assert is_constant(plan.right_support[last.start :])


@EVERY_GAIT
def test_steps_are_counted_from_their_single_support_on(gait):
    plan = plan_of(gait)
    begun = np.zeros(len(plan.step_index), dtype=int)
    for rows in single_supports(plan):
        begun[rows.start :] += 1
    np.testing.assert_array_equal(plan.step_index, begun)


@EVERY_GAIT
def test_in_single_support_the_zmp_rests_at_the_centre_of_the_support_sole(gait):
    plan = plan_of(gait)
    for rows in single_supports(plan):
        expected = np.broadcast_to(
            stance_sole_centre(plan, rows.start), (rows.stop - rows.start, 2)
        )
        np.testing.assert_allclose(plan.zmp_reference[rows], expected, atol=1e-12)


@EVERY_GAIT
def test_the_zmp_moves_no_faster_than_a_quintic(gait):
    plan = plan_of(gait)
    step = np.linalg.norm(np.diff(plan.zmp_reference, axis=0), axis=1).max()
    farthest = np.hypot(gait.step_length_m, 2 * HALF_SPACING)
    assert step < 1.001 * 1.875 * farthest * 0.002 / gait.double_support_s


@EVERY_GAIT
def test_the_walk_starts_between_the_feet(gait):
    np.testing.assert_array_equal(plan_of(gait).zmp_reference[0], [AHEAD, 0.0])


@EVERY_GAIT
def test_the_walk_ends_between_the_feet(gait):
    plan = plan_of(gait)
    middle = 0.5 * (plan.left_foot[-1] + plan.right_foot[-1])[:2] + (AHEAD, 0.0)
    np.testing.assert_allclose(plan.zmp_reference[-1], middle, rtol=0, atol=1e-12)


@EVERY_GAIT
def test_nothing_moves_before_the_first_shift(gait):
    plan = plan_of(gait)
    standing = slice(0, round(gait.stand_s / 0.002) + 1)
    moving = (plan.zmp_reference, plan.left_foot, plan.right_foot)
    assert max(np.ptp(each[standing], axis=0).max() for each in moving) == 0.0


@EVERY_GAIT
def test_nothing_moves_after_the_last_shift(gait):
    plan = plan_of(gait)
    still_s = gait.single_support_s - gait.stand_s
    standing = slice(plan.ticks - int(still_s / 0.002) + 1, None)
    moving = (plan.zmp_reference, plan.left_foot, plan.right_foot)
    assert max(np.ptp(each[standing], axis=0).max() for each in moving) < 1e-12


def test_the_robot_stands_for_a_while_after_the_end(plan):
    assert len(plan.zmp_reference) == plan.ticks + 610


@pytest.mark.parametrize("blend", [quintic, swing_bump])
def test_a_blend_starts_and_ends_without_speed_and_acceleration(blend):
    h = 1e-4
    s = np.array([0.0, h, 2 * h, 1 - 2 * h, 1 - h, 1.0])
    from_the_ends = blend(s) - blend(np.array([0.0, 0.0, 0.0, 1.0, 1.0, 1.0]))
    # What is left is cubic in the distance from the end: 64 h^3 at the most.
    assert np.abs(from_the_ends).max() < 70 * (2 * h) ** 3


@pytest.mark.parametrize("blend", [quintic, swing_bump])
def test_a_blend_holds_its_ends(blend):
    s = np.array([-5.0, 0.0, 1.0, 5.0])
    at_ends = blend(s)
    np.testing.assert_array_equal(at_ends[[0, 3]], at_ends[[1, 2]])


def test_the_quintic_goes_from_zero_to_one():
    np.testing.assert_array_equal(quintic(np.array([0.0, 0.5, 1.0])), [0.0, 0.5, 1.0])


def test_the_swing_bump_is_one_in_the_middle():
    np.testing.assert_array_equal(swing_bump(np.array([0.0, 0.5, 1.0])), [0, 1, 0])
