"""In-plane quadrature points of the shell and the basis functions at them (eqs. 40-43)."""

from __future__ import annotations

from typing import Any, NamedTuple

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.compiled import inlined
from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid


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
    """

    points: int
    columns: int
    first1: Any
    first2: Any
    values1: Any
    values2: Any


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
    basis = Basis(points, patch.second.size, first1[::points], first2[::points], values1, values2)
    return basis, (grid.weights1[:, None] * grid.weights2).ravel()


def _table(space: SplineSpace, x: Array) -> tuple[Any, Array]:
    first, values = space.local(x, 2)
    return first.copy(), values.transpose(1, 0, 2).copy()


@inlined
def shape_values(values1: Any, values2: Any, shape: Any) -> None:
    """N of the local functions into ``shape`` (local function,).

    Apart from the derivatives: the force and the tangent, assembled in every iteration, need these
    only, and writing N too costs them 3 %.
    """
    columns = values2.shape[1]
    for a in range(values1.shape[1]):
        for b in range(columns):
            shape[a * columns + b] = values1[0, a] * values2[0, b]


@inlined
def shape_derivatives(values1: Any, values2: Any, shapes: Any) -> None:
    """N_,1 N_,2 N_,11 N_,22 N_,12 of the local functions into ``shapes`` (5, local function)."""
    columns = values2.shape[1]
    for a in range(values1.shape[1]):
        for b in range(columns):
            k = a * columns + b
            shapes[0, k] = values1[1, a] * values2[0, b]
            shapes[1, k] = values1[0, a] * values2[1, b]
            shapes[2, k] = values1[2, a] * values2[0, b]
            shapes[3, k] = values1[0, a] * values2[2, b]
            shapes[4, k] = values1[1, a] * values2[1, b]
