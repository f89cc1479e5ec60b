"""The uniform B-spline against its defining properties and SciPy's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import BSpline

from biped_common.bspline import uniform_bspline

ORDERS = pytest.mark.parametrize("order", [3, 4])


@ORDERS
@settings(deadline=None, max_examples=50)
@given(st.floats(0.0, 1.0))
def test_its_shifts_add_up_to_one(order, u):
    shifts = u + np.arange(order)
    assert uniform_bspline(shifts, order).sum() == pytest.approx(1.0, abs=1e-13)


@ORDERS
def test_its_integral_is_one(order):
    # Two Gauss points per knot interval are exact up to the cubic.
    points = np.array([-1.0, 1.0]) / np.sqrt(3.0)
    u = np.arange(order)[:, None] + 0.5 + 0.5 * points
    assert 0.5 * uniform_bspline(u, order).sum() == pytest.approx(1.0, abs=1e-13)


@ORDERS
def test_scipy_has_the_same(order):
    u = np.linspace(0.0, order, 1001)[:-1]
    expected = BSpline.basis_element(np.arange(order + 1))(u)
    np.testing.assert_allclose(uniform_bspline(u, order), expected, rtol=0, atol=1e-13)


@ORDERS
def test_it_vanishes_outside_its_support(order):
    u = np.array([-100.0, -1e-9, 0.0, order, order + 1e-9, 100.0])
    np.testing.assert_array_equal(uniform_bspline(u, order), np.zeros(6))


@ORDERS
def test_it_is_positive_within_its_support(order):
    u = np.linspace(0.0, order, 1001)[10:-10]
    assert uniform_bspline(u, order).min() > 0.0


@ORDERS
def test_the_answer_has_the_shape_of_the_question(order):
    assert uniform_bspline(np.zeros((2, 3, 4)), order).shape == (2, 3, 4)
