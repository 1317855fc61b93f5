"""Gauss-Legendre rules on intervals, knot spans and patches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch


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


@dataclass(frozen=True)
class QuadratureGrid:
    """In-plane Gauss points of a patch as a tensor grid of parameters.

    The points of direction 1, element by element, times those of direction 2; direction 2 fastest.

    Attributes
    ----------
    theta1, theta2
        Parameters, shapes ``(elements * points,)``.
    weights1, weights2
        Gauss weights in the same order (parametric length, without the surface's area factor).
    """

    theta1: Array
    theta2: Array
    weights1: Array
    weights2: Array


def quadrature_grid(patch: Patch, points: int) -> QuadratureGrid:
    """Gauss points of all elements of a patch, ``points`` per element and direction."""
    (t1, w1), (t2, w2) = (gauss_on_spans(space.breaks, points) for space in patch.spaces)
    return QuadratureGrid(t1.ravel(), t2.ravel(), w1.ravel(), w2.ravel())


def quadrature_grid(
    breaks1: Array, breaks2: Array, points: int
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Tensor grid of Gauss points over the knot spans of a patch.

    Points of direction 1 run element by element, so do those of direction 2; the grid is numbered
    with direction 2 fastest.

    Parameters
    ----------
    breaks1, breaks2
        Distinct knots of both directions.
    points
        Gauss points per knot span and direction.

    Returns
    -------
    (theta1, weight1), (theta2, weight2)
        Parameters and weights per direction, each of shape ``(spans * points,)``.

    Examples
    --------
    >>> (x, wx), (y, wy) = quadrature_grid(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0]), 2)
    >>> x.size, y.size, round(float(wx @ x * (wy @ y)), 12)  # integral of x y over [0,3] x [0,2]
    (4, 2, 9.0)
    """
    rules = [gauss_on_spans(breaks, points) for breaks in (breaks1, breaks2)]
    (x1, w1), (x2, w2) = [(x.ravel(), w.ravel()) for x, w in rules]
    return (x1, w1), (x2, w2)
