"""Waist segments: the static walk plus the correction, handed out piece by piece."""

import dataclasses

import numpy as np
import pytest
from tests.robots import SHIPPED

from msgs_json.segment import WaistSegment
from trajectory_node.bspline import CorrectionSpline
from trajectory_node.errors import InfeasibleGaitError, TrajectoryError
from trajectory_node.settings import CorrectionSettings, GaitSettings
from trajectory_node.waist_reference import WaistReference

SEGMENTS = 563  # 5625 control ticks
NONE = np.zeros(2)
ACTIONS = np.random.default_rng(6).uniform(-0.024, 0.024, (SEGMENTS, 2))
ARRAYS = [f.name for f in dataclasses.fields(WaistSegment)][2:]
EVERY_ARRAY = pytest.mark.parametrize("name", ARRAYS)


def new_reference(**kwargs: int) -> WaistReference:
    return WaistReference(SHIPPED, GaitSettings(), CorrectionSettings(), **kwargs)


def segments(reference: WaistReference, actions: np.ndarray) -> list[WaistSegment]:
    """Return one segment per action."""
    return [reference.segment(action) for action in actions]


def assert_same(a: list[WaistSegment], b: list[WaistSegment]) -> None:
    """Compare segments bit by bit."""
    assert len(a) == len(b)
    for one, other in zip(a, b, strict=True):
        np.testing.assert_equal(dataclasses.asdict(one), dataclasses.asdict(other))


@pytest.fixture(scope="module")
def corrected() -> list[WaistSegment]:
    """Walk once with random corrections."""
    return segments(new_reference(), ACTIONS)


def test_the_segments_follow_each_other_without_a_gap(corrected):
    ends = [segment.first_tick + segment.n_ticks for segment in corrected]
    assert [segment.first_tick for segment in corrected] == [0, *ends[:-1]]


def test_the_last_segment_has_five_ticks(corrected):
    lengths = [segment.n_ticks for segment in corrected]
    assert lengths == [10] * 562 + [5]


def test_a_segment_has_a_row_more_than_ticks(corrected):
    assert {len(segment.waist) for segment in corrected} == {11}


def test_without_corrections_the_waist_is_that_of_the_static_walk():
    reference = new_reference()
    waist = np.concatenate(
        [s.waist[: s.n_ticks] for s in segments(reference, np.zeros((SEGMENTS, 2)))]
    )
    np.testing.assert_array_equal(waist, reference.static_waist[: reference.ticks])


def test_the_correction_is_added_to_the_static_walk(corrected):
    static = new_reference().static_waist
    spline = CorrectionSpline(CorrectionSettings(), 11)
    for segment, action in zip(corrected, ACTIONS, strict=True):
        expected = spline.push(action, static[segment.first_tick :][:11])
        np.testing.assert_array_equal(segment.waist, expected)


@EVERY_ARRAY
def test_a_segment_begins_where_the_one_before_ends(corrected, name):
    ends = np.array([getattr(s, name)[10] for s in corrected[:-1]], dtype=float)
    starts = np.array([getattr(s, name)[0] for s in corrected[1:]], dtype=float)
    np.testing.assert_allclose(ends, starts, rtol=0, atol=1e-12)


@pytest.mark.parametrize("name", ARRAYS[1:])
def test_the_rest_of_a_segment_is_as_planned(corrected, name):
    planned = getattr(new_reference().plan, name)
    for segment in corrected:
        expected = planned[segment.first_tick :][:11]
        np.testing.assert_array_equal(getattr(segment, name), expected)


def test_look_ahead_adds_rows():
    assert len(new_reference(look_ahead_ticks=40).segment(NONE).waist) == 50


def test_look_ahead_does_not_change_the_segment(corrected):
    for segment, longer in zip(
        corrected, segments(new_reference(look_ahead_ticks=40), ACTIONS), strict=True
    ):
        np.testing.assert_array_equal(segment.waist, longer.waist[:11])


@pytest.mark.parametrize("look_ahead_ticks", [0, -1, 601])
def test_look_ahead_out_of_range_is_refused(look_ahead_ticks):
    message = f"^look_ahead_ticks = {look_ahead_ticks}: must be between 1 and 600$"
    with pytest.raises(TrajectoryError, match=message):
        new_reference(look_ahead_ticks=look_ahead_ticks)


BAD_CORRECTIONS = pytest.mark.parametrize(
    "correction",
    [
        np.array([np.nan, 0.0]),
        np.array([0.0, np.inf]),
        np.zeros(3),
        np.zeros((1, 2)),
        np.zeros(()),
    ],
    ids=["nan", "inf", "three", "nested", "scalar"],
)


@BAD_CORRECTIONS
def test_a_correction_must_be_two_finite_numbers(correction):
    with pytest.raises(TrajectoryError, match="must be two finite numbers"):
        new_reference().segment(correction)


@BAD_CORRECTIONS
def test_a_refused_correction_leaves_no_trace(corrected, correction):
    reference = new_reference()
    before = segments(reference, ACTIONS[:20])
    with pytest.raises(TrajectoryError):
        reference.segment(correction)
    assert_same(before + segments(reference, ACTIONS[20:60]), corrected[:60])


def test_after_the_end_there_is_nothing_to_hand_out():
    reference = new_reference()
    segments(reference, ACTIONS)
    with pytest.raises(TrajectoryError, match=r"^the walk of 5625 ticks is over$"):
        reference.segment(NONE)


def test_a_reset_goes_back_to_the_start(corrected):
    reference = new_reference()
    segments(reference, np.full((100, 2), 0.01))
    reference.reset()
    assert_same(segments(reference, ACTIONS), corrected)


def test_a_walk_can_be_reset_after_its_end(corrected):
    reference = new_reference()
    segments(reference, ACTIONS)
    reference.reset()
    assert_same(segments(reference, ACTIONS[:1]), corrected[:1])


@pytest.mark.parametrize("at", [0, 1, 59, 300, SEGMENTS - 1])
def test_a_snapshot_goes_on_bit_for_bit(corrected, at):
    reference = new_reference()
    segments(reference, ACTIONS[:at])
    snapshot = reference.snapshot()
    segments(reference, np.full((SEGMENTS - at, 2), 0.02))
    reference.restore(snapshot)
    assert_same(segments(reference, ACTIONS[at:]), corrected[at:])


def test_a_snapshot_goes_on_in_another_reference(corrected):
    reference, other = new_reference(), new_reference()
    segments(reference, ACTIONS[:77])
    other.restore(reference.snapshot())
    assert_same(segments(other, ACTIONS[77:]), corrected[77:])


def test_a_snapshot_of_another_spline_is_refused():
    smoother = WaistReference(
        SHIPPED, GaitSettings(), CorrectionSettings(knot_spacing_s=0.6)
    )
    with pytest.raises(ValueError, match="this spline keeps"):
        new_reference().restore(smoother.snapshot())


def test_an_infeasible_gait_is_refused_at_once():
    with pytest.raises(InfeasibleGaitError):
        WaistReference(SHIPPED, GaitSettings(step_length_m=0.3), CorrectionSettings())


def test_a_segment_cannot_be_changed(corrected):
    with pytest.raises(dataclasses.FrozenInstanceError):
        corrected[0].first_tick = 5


def test_look_ahead_is_whole_in_the_last_segment():
    last = segments(new_reference(look_ahead_ticks=600), ACTIONS)[-1]
    assert {len(getattr(last, name)) for name in ARRAYS} == {610}


def test_look_ahead_beyond_the_end_stands():
    reference = new_reference(look_ahead_ticks=600)
    last = segments(reference, np.zeros((SEGMENTS, 2)))[-1]
    beyond = last.waist[last.n_ticks :]
    np.testing.assert_allclose(beyond, reference.static_waist[-1:].repeat(605, axis=0))


@pytest.mark.parametrize("look_ahead_ticks", [1, 50])
def test_a_reference_tells_the_rows_of_its_segments(look_ahead_ticks):
    reference = new_reference(look_ahead_ticks=look_ahead_ticks)
    assert reference.rows == len(reference.segment(NONE).waist)


def test_a_reference_tells_where_its_next_segment_starts():
    reference = new_reference()
    told = []
    for _ in range(3):
        told.append(reference.tick)
        assert reference.segment(NONE).first_tick == told[-1]
    assert told == [0, 10, 20]


def test_at_the_end_a_reference_is_at_its_last_tick():
    reference = new_reference()
    segments(reference, ACTIONS)
    assert reference.tick == reference.ticks


@EVERY_ARRAY
def test_the_stance_is_where_walks_start(corrected, name):
    stance = getattr(new_reference().stance(), name)
    np.testing.assert_array_equal(stance, getattr(corrected[0], name)[:1])


def test_the_stance_has_no_tick_to_walk():
    stance = new_reference().stance()
    assert (stance.first_tick, stance.n_ticks) == (0, 0)


def test_the_stance_stays_the_same_in_a_walk():
    reference = new_reference()
    segments(reference, ACTIONS[:100])
    assert_same([reference.stance()], [new_reference().stance()])


def test_asking_for_the_stance_does_not_move_the_walk_on(corrected):
    reference = new_reference()
    reference.stance()
    assert_same(segments(reference, ACTIONS[:2]), corrected[:2])
