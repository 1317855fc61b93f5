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
    """Gauss points of all elements of a patch, ``points`` per element and direction.

    Examples
    --------
    >>> grid = quadrature_grid(Patch.rectangle(3.0, 2.0).refine(2, (4, 2)), 3)
    >>> grid.theta1.size, grid.theta2.size, round(float(grid.weights1.sum()), 12)
    (12, 6, 1.0)
    """
    (t1, w1), (t2, w2) = (gauss_on_spans(space.breaks, points) for space in patch.spaces)
    return QuadratureGrid(t1.ravel(), t2.ravel(), w1.ravel(), w2.ravel())


def moments(patch: Patch, grid: QuadratureGrid, density: Array) -> Array:
    """Integrals of the basis functions times a density, as the nodal forces of a load.

    Two small matrix products instead of a sum over points.

    Parameters
    ----------
    density
        At the grid points, times Gauss weights and area element, shape ``(point, ...)``.

    Returns
    -------
    Array
        Shape ``(control point, ...)``.

    Examples
    --------
    >>> film = Patch.rectangle(3.0, 2.0)
    >>> grid = quadrature_grid(film, 2)
    >>> moments(film, grid, 6.0 * np.outer(grid.weights1, grid.weights2).ravel()).tolist()
    [1.5, 1.5, 1.5, 1.5]
    """
    n1, n2 = patch.first.evaluate(grid.theta1), patch.second.evaluate(grid.theta2)
    values = density.reshape(grid.theta1.size, grid.theta2.size, *density.shape[1:])
    if patch.weights is not None:
        total = n1 @ patch.weights @ n2.T
        values = values / total.reshape(*total.shape, *(1,) * (density.ndim - 1))
    sums = np.einsum("ai,bj,ab...->ij...", n1, n2, values, optimize=True)
    if patch.weights is not None:
        sums = sums * patch.weights.reshape(*patch.weights.shape, *(1,) * (density.ndim - 1))
    return np.ascontiguousarray(sums.reshape(patch.size, *density.shape[1:]))
