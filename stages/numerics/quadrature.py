"""Gauss-Legendre rules on intervals, knot spans and layers."""

from __future__ import annotations

import numpy as np

from stages.numerics.bsplines import Array


def gauss(points: int, start: float = -1.0, stop: float = 1.0) -> tuple[Array, Array]:
    """Gauss-Legendre points and weights on an interval; exact to degree ``2 points - 1``.

    Examples
    --------
    >>> x, w = gauss(2, 0.0, 3.0)
    >>> round(float(w @ x**3), 12)
    20.25
    """
    if points < 1:
        raise ValueError(f"a Gauss rule of {points} points does not exist")
    x, w = np.polynomial.legendre.leggauss(points)
    half = 0.5 * (stop - start)
    return start + half * (x + 1.0), half * w


def gauss_on_spans(breaks: Array, points: int) -> tuple[Array, Array]:
    """Gauss points and weights in every span of ``breaks``, each of shape ``(spans, points)``."""
    x, w = gauss(points, 0.0, 1.0)
    width = np.diff(np.asarray(breaks, dtype=float))
    return np.asarray(breaks)[:-1, None] + width[:, None] * x, width[:, None] * w
