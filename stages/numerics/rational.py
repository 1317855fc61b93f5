"""Rational splines: homogeneous coordinates and the quotient rule."""

from __future__ import annotations

from collections.abc import Callable
from math import comb

import numpy as np

from stages.numerics.bsplines import Array


def homogeneous(control_points: Array, weights: Array) -> Array:
    """Control points (w B, w) of a rational patch in four dimensions, shape ``(m1, m2, 4)``."""
    return np.concatenate((weights[..., None] * control_points, weights[..., None]), axis=-1)


def quotient(parts: Callable[[int, int], tuple[Array, Array]], orders: tuple[int, int]) -> Array:
    """Derivative (k, m) of a quotient S = A / W of functions of two parameters.

    From the product rule for A = W S, in increasing order:
    S^(k,m) = (A^(k,m) - sum_(i,j) binom(k,i) binom(m,j) W^(i,j) S^(k-i,m-j)) / W, (i, j) != (0, 0).

    Parameters
    ----------
    parts
        A^(k,m), shape ``(point, n)``, and W^(k,m), shape ``(point,)``.
    orders
        k and m.

    References
    ----------
    Piegl and Tiller, The NURBS Book (1997), eq. 4.20.
    """
    wanted = [(k, m) for k in range(orders[0] + 1) for m in range(orders[1] + 1)]
    denominator: dict[tuple[int, int], Array] = {}
    found: dict[tuple[int, int], Array] = {}
    for k, m in wanted:
        numerator, denominator[k, m] = parts(k, m)
        value = numerator.copy()
        for i, j in wanted[1:]:
            if i <= k and j <= m:
                value -= comb(k, i) * comb(m, j) * denominator[i, j][:, None] * found[k - i, m - j]
        found[k, m] = value / denominator[0, 0][:, None]
    return found[orders]


def check_weights(weights: Array, shape: tuple[int, ...]) -> None:
    """Raise ``ValueError`` unless there is one positive weight per control point of a net."""
    if weights.shape != shape:
        raise ValueError(
            f"weights of shape {weights.shape} do not fit a net of {shape[0]} x {shape[1]} control "
            f"points: one each"
        )
    bad = np.argwhere(~((weights > 0) & np.isfinite(weights)))
    if bad.size:
        row, column = bad[0]
        raise ValueError(
            f"the weight of control point ({row}, {column}) is {weights[row, column]:g}: weights are "
            f"positive numbers, so that the surface stays finite"
        )
