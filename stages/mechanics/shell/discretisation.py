"""In-plane quadrature points of the shell and the basis functions at them (eqs. 40-43)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.compiled import inlined
from stages.numerics.patches import Patch
from stages.numerics.quadrature import QuadratureGrid, quadrature_grid


class Rational(NamedTuple):
    """What turns products of univariate functions into the functions of a rational patch.

    Attributes
    ----------
    weights
        w of each control point, shape ``(control point,)``.
    totals
        W = sum w N, W_,1 W_,2 W_,11 W_,22 W_,12 at the quadrature points, shape ``(point, 6)``.
    """

    weights: Any
    totals: Any


class Basis(NamedTuple):
    """Univariate basis functions at the tensor grid of quadrature points.

    Kernels form the products themselves: 1-D tables are small enough to stay in the cache. Points are
    numbered as in :func:`stages.numerics.quadrature.quadrature_grid`, control points as in
    :class:`stages.numerics.patches.Patch`.

    Attributes
    ----------
    points
        Quadrature points per element and direction.
    columns
        m2, control points along direction 2.
    first1, first2
        First non-zero function of each element, shape ``(elements,)``.
    values1, values2
        Functions and their first two derivatives, shape ``(elements * points, 3, p + 1)``.
    rational
        Weights of a rational patch. None has a type of its own, so that kernels compiled for a
        polynomial patch do not even hold the division.
    """

    points: int
    columns: int
    first1: Any
    first2: Any
    values1: Any
    values2: Any
    rational: Rational | None


def basis_on_grid(patch: Patch, points: int) -> tuple[Basis, Array]:
    """Basis of a patch at ``points`` Gauss points per element and direction, and the weights.

    Returns
    -------
    basis
        The univariate tables.
    weights
        w1 w2 at each grid point, shape ``(quadrature point,)``; they do not hold the area element.
    """
    grid = quadrature_grid(patch, points)
    first1, values1 = _table(patch.first, grid.theta1)
    first2, values2 = _table(patch.second, grid.theta2)
    firsts = first1[::points], first2[::points]
    rational = _rational(patch, grid)
    basis = Basis(points, patch.second.size, *firsts, values1, values2, rational)
    return basis, (grid.weights1[:, None] * grid.weights2).ravel()


def _table(space: SplineSpace, x: Array) -> tuple[Any, Array]:
    first, values = space.local(x, 2)
    return first.copy(), values.transpose(1, 0, 2).copy()


def _rational(patch: Patch, grid: QuadratureGrid) -> Rational | None:
    if patch.weights is None:
        return None
    n1 = [patch.first.evaluate(grid.theta1, k) for k in range(3)]
    n2 = [patch.second.evaluate(grid.theta2, k) for k in range(3)]
    orders = ((0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1))
    totals = [(n1[k] @ patch.weights @ n2[m].T).ravel() for k, m in orders]
    return Rational(patch.weights.ravel().copy(), np.stack(totals, axis=1))


@inlined
def shape_values(basis: Any, g1: int, g2: int, shape: Any) -> None:
    """R of the local functions at grid point (g1, g2) into ``shape`` (local function,).

    Apart from the derivatives: the force and the tangent, assembled in every iteration, need these
    only, and writing R too costs them 3 %.
    """
    values1, values2 = basis.values1[g1], basis.values2[g2]
    columns = values2.shape[1]
    for a in range(values1.shape[1]):
        for b in range(columns):
            shape[a * columns + b] = values1[0, a] * values2[0, b]
    _divide_values(basis.rational, basis, g1, g2, shape)


@inlined
def shape_derivatives(basis: Any, g1: int, g2: int, shapes: Any) -> None:
    """R_,1 R_,2 R_,11 R_,22 R_,12 of the local functions into ``shapes`` (5, local function)."""
    values1, values2 = basis.values1[g1], basis.values2[g2]
    columns = values2.shape[1]
    for a in range(values1.shape[1]):
        for b in range(columns):
            k = a * columns + b
            shapes[0, k] = values1[1, a] * values2[0, b]
            shapes[1, k] = values1[0, a] * values2[1, b]
            shapes[2, k] = values1[2, a] * values2[0, b]
            shapes[3, k] = values1[0, a] * values2[2, b]
            shapes[4, k] = values1[1, a] * values2[1, b]
    _divide_derivatives(basis.rational, basis, g1, g2, shapes)


@inlined
def _divide_values(rational: Any, basis: Any, g1: int, g2: int, shape: Any) -> None:
    """From N to R = w N / W; nothing on a polynomial patch, where numba drops the branch."""
    if rational is not None:
        columns = basis.values2.shape[2]
        corner = basis.first1[g1 // basis.points] * basis.columns + basis.first2[g2 // basis.points]
        inverse = 1.0 / rational.totals[g1 * basis.values2.shape[0] + g2, 0]
        for k in range(shape.size):
            c = corner + (k // columns) * basis.columns + k % columns
            shape[k] *= rational.weights[c] * inverse


@inlined
def _divide_derivatives(rational: Any, basis: Any, g1: int, g2: int, shapes: Any) -> None:
    """From N to R, by the quotient rule:

    R_,a = (w N_,a - R W_,a) / W and R_,ab = (w N_,ab - R_,a W_,b - R_,b W_,a - R W_,ab) / W.
    """
    if rational is not None:
        columns = basis.values2.shape[2]
        corner = basis.first1[g1 // basis.points] * basis.columns + basis.first2[g2 // basis.points]
        total = rational.totals[g1 * basis.values2.shape[0] + g2]
        inverse = 1.0 / total[0]
        for k in range(shapes.shape[1]):
            a, b = k // columns, k % columns
            w = rational.weights[corner + a * basis.columns + b]
            r = w * basis.values1[g1, 0, a] * basis.values2[g2, 0, b] * inverse
            r1 = (w * shapes[0, k] - r * total[1]) * inverse
            r2 = (w * shapes[1, k] - r * total[2]) * inverse
            shapes[0, k], shapes[1, k] = r1, r2
            shapes[2, k] = (w * shapes[2, k] - 2.0 * r1 * total[1] - r * total[3]) * inverse
            shapes[3, k] = (w * shapes[3, k] - 2.0 * r2 * total[2] - r * total[4]) * inverse
            shapes[4, k] = (
                w * shapes[4, k] - r1 * total[2] - r2 * total[1] - r * total[5]
            ) * inverse
