"""The waist correction against the plain sum over all past actions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from trajectory_node.bspline import CorrectionSpline
from trajectory_node.settings import CorrectionSettings

T = 0.02  # learning tick [s]
DT = 0.002  # control tick [s]
ROWS = 11  # a learning tick and the row at its end
LARGEST_M = 0.024

untimed = settings(deadline=None, max_examples=30)
splines = st.builds(
    CorrectionSettings,
    knot_spacing_s=st.floats(0.2, 1.0),
    order=st.sampled_from([3, 4]),
)
action_seeds = st.integers(0, 2**32 - 1)


def random_actions(seed: int, n: int) -> np.ndarray:
    """Return (n, 2) corrections within the range of the learner's [m]."""
    return np.random.default_rng(seed).uniform(-LARGEST_M, LARGEST_M, (n, 2))


def corrections(spline: CorrectionSpline, actions_m: np.ndarray) -> np.ndarray:
    """Return (n, rows, 2), what the spline answers to each action [m]."""
    rows = spline._weights.shape[0]
    at_rest = np.zeros((rows, 3))
    return np.array([spline.push(action, at_rest)[:, :2] for action in actions_m])


def naive_corrections(
    settings: CorrectionSettings, actions_m: np.ndarray, rows: int
) -> np.ndarray:
    """Return sum_k a_k (T / h) B((t - t_k) / h) over all past actions, term by term."""
    h = settings.knot_spacing_s
    bump = BSpline.basis_element(np.arange(settings.order + 1), extrapolate=False)
    answer = np.zeros((len(actions_m), rows, 2))
    for n in range(len(actions_m)):
        t = n * T + np.arange(rows) * DT
        for k in range(n + 1):
            weight = T / h * np.nan_to_num(bump((t - k * T) / h))
            answer[n] += weight[:, None] * actions_m[k]
    return answer


@untimed
@given(splines, action_seeds, st.integers(1, 120))
def test_the_correction_is_the_sum_over_all_past_actions(spline, seed, n):
    actions_m = random_actions(seed, n)
    found = corrections(CorrectionSpline(spline, ROWS), actions_m)
    expected = naive_corrections(spline, actions_m, ROWS)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


@pytest.mark.parametrize("order", [3, 4])
def test_look_ahead_is_the_spline_without_further_actions(order):
    spline = CorrectionSettings(order=order)
    actions_m = random_actions(1, 100)
    found = corrections(CorrectionSpline(spline, 60), actions_m)
    expected = naive_corrections(spline, actions_m, 60)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


@untimed
@given(splines, action_seeds)
def test_there_is_no_jump_from_one_segment_to_the_next(spline, seed):
    found = corrections(CorrectionSpline(spline, ROWS), random_actions(seed, 150))
    np.testing.assert_allclose(found[:-1, 10], found[1:, 0], rtol=0, atol=1e-12)


@untimed
@given(splines, action_seeds, action_seeds, st.floats(-3.0, 3.0))
def test_the_correction_is_linear_in_the_actions(spline, seed, other_seed, factor):
    a, b = random_actions(seed, 80), random_actions(other_seed, 80)
    of_a, of_b, of_both = (
        corrections(CorrectionSpline(spline, ROWS), actions_m)
        for actions_m in (a, b, a + factor * b)
    )
    np.testing.assert_allclose(of_both, of_a + factor * of_b, rtol=0, atol=1e-14)


@pytest.mark.parametrize("order", [3, 4])
@pytest.mark.parametrize("knot_spacing_s", [0.2, 0.24, 0.4])
def test_a_constant_action_becomes_the_correction(knot_spacing_s, order):
    settled = round(order * knot_spacing_s / T)
    spline = CorrectionSpline(CorrectionSettings(knot_spacing_s, order), ROWS)
    found = corrections(spline, np.tile([0.02, -0.01], (settled + 50, 1)))[settled:]
    expected = np.broadcast_to([0.02, -0.01], found.shape)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)


@untimed
@given(splines)
def test_a_constant_action_almost_becomes_the_correction_at_any_spacing(spline):
    actions_m = np.tile([0.02, -0.01], (250, 1))
    found = corrections(CorrectionSpline(spline, ROWS), actions_m)[-1]
    np.testing.assert_allclose(found, np.tile([0.02, -0.01], (ROWS, 1)), rtol=1e-4)


@pytest.mark.parametrize("order", [3, 4])
def test_a_single_action_leaves_no_trace_after_the_support(order):
    spline = CorrectionSpline(CorrectionSettings(0.4, order), ROWS)
    corrections(spline, np.array([[0.02, -0.01]]))
    later = corrections(spline, np.zeros((200, 2)))
    support = round(order * 0.4 / T)
    assert np.flatnonzero(later.any(axis=(1, 2)))[-1] == support - 2


@pytest.mark.parametrize("order", [3, 4])
def test_a_single_action_adds_its_own_area(order):
    actions_m = np.zeros((250, 2))
    actions_m[0] = (0.02, -0.01)
    spline = CorrectionSpline(CorrectionSettings(0.4, order), ROWS)
    area = corrections(spline, actions_m)[:, :10].sum(axis=(0, 1)) * DT
    np.testing.assert_allclose(area, actions_m[0] * T, rtol=0, atol=1e-15)


def test_an_action_begins_to_act_at_once_but_without_a_jump():
    spline = CorrectionSpline(CorrectionSettings(), ROWS)
    x = corrections(spline, np.array([[0.02, 0.0]]))[0, :, 0]
    assert x[0] == 0.0 < x[1]


def test_a_snapshot_restores_the_history_bit_for_bit():
    actions_m = random_actions(2, 200)
    spline = CorrectionSpline(CorrectionSettings(), ROWS)
    corrections(spline, actions_m[:77])
    snapshot = spline.snapshot()
    expected = corrections(spline, actions_m[77:])
    other = CorrectionSpline(CorrectionSettings(), ROWS)
    corrections(other, random_actions(3, 13))
    other.restore(snapshot)
    np.testing.assert_array_equal(corrections(other, actions_m[77:]), expected)


def test_a_snapshot_lists_the_actions_newest_first():
    actions_m = random_actions(2, 77)
    spline = CorrectionSpline(CorrectionSettings(), ROWS)
    corrections(spline, actions_m)
    snapshot = spline.snapshot()
    np.testing.assert_array_equal(snapshot, actions_m[::-1][: len(snapshot)])


def test_a_snapshot_stays_as_it_is_while_the_spline_goes_on():
    spline = CorrectionSpline(CorrectionSettings(), ROWS)
    corrections(spline, random_actions(2, 77))
    snapshot = spline.snapshot()
    before = snapshot.copy()
    corrections(spline, random_actions(3, 77))
    np.testing.assert_array_equal(snapshot, before)


def test_a_history_of_another_length_is_refused():
    snapshot = CorrectionSpline(CorrectionSettings(knot_spacing_s=0.4), ROWS).snapshot()
    spline = CorrectionSpline(CorrectionSettings(knot_spacing_s=0.2), ROWS)
    with pytest.raises(ValueError, match=r"\(60, 2\), this spline keeps \(30, 2\)"):
        spline.restore(snapshot)


def test_a_reset_forgets_all_actions():
    spline = CorrectionSpline(CorrectionSettings(), ROWS)
    corrections(spline, random_actions(2, 77))
    spline.reset()
    assert not corrections(spline, np.zeros((1, 2))).any()


def test_the_correction_is_added_to_the_waist_and_leaves_its_height():
    waist = np.random.default_rng(7).normal(size=(ROWS, 3))
    action_m = np.array([0.02, -0.01])
    found = CorrectionSpline(CorrectionSettings(), ROWS).push(action_m, waist)
    spline = CorrectionSpline(CorrectionSettings(), ROWS)
    expected = waist + np.pad(corrections(spline, action_m[None])[0], ((0, 0), (0, 1)))
    np.testing.assert_array_equal(found, expected)
