"""Plan and bare positions together are the trajectory's segments, to the last bit."""

import dataclasses

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.payloads import PLAN
from tests.robots import SHIPPED

from biped_ros.messages import segment_values
from msgs_json.walk_plan import WalkPlan
from msgs_json.wire import RefusedMessageError, decode, encode
from sim_node.planned_walk import PlannedWalk
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference


def reference(steps=5, look_ahead_ticks=50):
    return WaistReference(
        SHIPPED, GaitSettings(steps=steps), CorrectionSettings(), look_ahead_ticks
    )


def announced(plan):
    """Return a plan as it comes over the graph."""
    return PlannedWalk(decode(WalkPlan, encode(plan)))


def same(found, expected):
    np.testing.assert_equal(dataclasses.asdict(found), dataclasses.asdict(expected))


def refused(text):
    return pytest.raises(RefusedMessageError, match=text)


@settings(deadline=None, max_examples=10)
@given(st.integers(1, 6), st.sampled_from([1, 7, 50]), st.integers(0, 2**32 - 1))
def test_every_segment_of_a_walk_comes_out_again(steps, look_ahead_ticks, seed):
    trajectory = reference(steps, look_ahead_ticks)
    walk, rng = announced(trajectory.walk_plan()), np.random.default_rng(seed)
    while trajectory.tick < trajectory.ticks:
        segment = trajectory.segment(rng.uniform(-0.024, 0.024, 2))
        same(walk.segment(segment.first_tick, segment_values(segment)), segment)


def test_the_stance_comes_out_again():
    trajectory = reference()
    same(announced(trajectory.walk_plan()).stance, trajectory.stance())


def test_a_plan_has_a_phase_for_each_support():
    phases = [
        (phase.right_support, phase.double_support, phase.step_index)
        for phase in reference(steps=2).walk_plan().phases
    ]
    assert phases == [
        (False, True, 0),
        (False, False, 1),
        (True, True, 1),
        (True, False, 2),
        (True, True, 2),
    ]


@pytest.mark.parametrize(
    "ticks", [[], [5], [0, 20, 10], [0, 10, 10]], ids=["none", "late", "back", "twice"]
)
def test_phases_must_follow_one_another_from_the_start(ticks):
    phases = [msgspec.structs.replace(PLAN.phases[0], from_tick=t) for t in ticks]
    with refused("must follow one another from 0"):
        PlannedWalk(msgspec.structs.replace(PLAN, phases=tuple(phases)))


@pytest.mark.parametrize("name", ["from_tick", "step_index"])
def test_an_endless_number_in_a_phase_is_refused(name):
    endless = msgspec.structs.replace(PLAN.phases[1], **{name: 2**70})
    plan = msgspec.structs.replace(PLAN, phases=(PLAN.phases[0], endless))
    with refused("endless number"):
        PlannedWalk(plan)


@pytest.mark.parametrize("rows", [0, 1, 10])
def test_fewer_rows_than_ticks_to_be_walked_are_refused(rows):
    with refused(f"segment of {rows} rows from tick 0: 10 ticks cannot be walked"):
        PlannedWalk(PLAN).segment(0, np.zeros((rows, 4, 3)))


def test_the_last_segment_of_a_walk_may_be_a_short_one():
    walk = PlannedWalk(msgspec.structs.replace(PLAN, walk_ticks=25))
    assert walk.segment(20, np.zeros((6, 4, 3))).n_ticks == 5


def test_beyond_the_end_of_the_walk_nothing_is_walked():
    walk = PlannedWalk(msgspec.structs.replace(PLAN, walk_ticks=20))
    with refused("0 ticks cannot be walked"):
        walk.segment(20, np.zeros((60, 4, 3)))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_position_that_is_no_number_is_refused(bad):
    positions = np.zeros((60, 4, 3))
    positions[59, 3, 2] = bad
    with refused("not finite"):
        PlannedWalk(PLAN).segment(0, positions)
