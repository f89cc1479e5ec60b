"""The uniform B-spline."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray


def uniform_bspline(u: NDArray[np.floating[Any]], order: int) -> NDArray[np.float64]:
    """Return the uniform B-spline B(u) of the given order, support [0, order].

    Args:
        u: any shape, time in knot spacings.
        order: degree + 1; 3 is quadratic, 4 cubic.
    """
    # Cardinal B-spline as a sum of truncated powers.
    degree = order - 1
    total = np.zeros_like(u, dtype=np.float64)
    for i in range(order + 1):
        weight = (-1) ** i * math.comb(order, i) / math.factorial(degree)
        total += weight * np.maximum(u - i, 0.0) ** degree
    return np.where((u > 0.0) & (u < order), total, 0.0)
