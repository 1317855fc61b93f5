"""From the Greville points of one patch to a tensor grid of parameters (eqs. 86-87), in two ways.

The spline through the values is accurate where the field is smooth. Where it switches between two
points, the spline swings to both sides of the switch and falls below zero; then a curve that keeps the
shape of the data is the better one.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

import numpy as np
from scipy.interpolate import PchipInterpolator

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch

TransferKind: TypeAlias = Literal["spline", "shape-preserving"]


class Transfer(Protocol):
    """Values at collocation points to values on a grid."""

    def __call__(self, values: Array) -> Array:
        """Shape ``(point,)`` to shape ``(grid point,)``, direction 2 fastest on both sides."""


@dataclass(frozen=True)
class SplineTransfer:
    """The spline through the collocated values (eq. 86), evaluated at the grid (eq. 87).

    In one direction after the other, each a small dense matrix ``(grid, n)``.
    """

    first: Array
    second: Array

    def __call__(self, values: Array) -> Array:
        """Shape ``(point,)`` to shape ``(grid point,)``, direction 2 fastest on both sides."""
        grid = values.reshape(self.first.shape[1], self.second.shape[1])
        return (self.first @ grid @ self.second.T).ravel()


@dataclass(frozen=True)
class ShapePreservingTransfer:
    """Monotone piecewise cubics through the values, along direction 1 and then along direction 2.

    Between two collocation points a curve stays between their values, so a result never leaves the
    range of the four collocated values around it (up to round-off): what is positive stays positive,
    and a front brings no swings. Smooth fields are met at second order at their extrema, at third
    or better elsewhere.

    Attributes
    ----------
    points1, points2
        Parameters of the collocation points.
    theta1, theta2
        Parameters of the grid.

    References
    ----------
    Fritsch and Butland (1984), A method for constructing local monotone piecewise cubic interpolants.
    """

    points1: Array
    points2: Array
    theta1: Array
    theta2: Array

    def __call__(self, values: Array) -> Array:
        """Shape ``(point,)`` to shape ``(grid point,)``, direction 2 fastest on both sides."""
        grid = values.reshape(self.points1.size, self.points2.size)
        along_first = PchipInterpolator(self.points1, grid, axis=0)(self.theta1)
        both = PchipInterpolator(self.points2, along_first, axis=1)(self.theta2)
        return np.asarray(both, dtype=float).ravel()


def surface_transfer(kind: TransferKind, source: Patch, theta1: Array, theta2: Array) -> Transfer:
    """Transfer from the Greville points of ``source`` to ``theta1`` x ``theta2``.

    Examples
    --------
    >>> film = Patch.rectangle(1.0, 1.0).refine(4, (3, 1))
    >>> front = np.repeat([0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], film.second.size)
    >>> at = np.array([0.1]), np.array([0.5])
    >>> surface_transfer("spline", film, *at)(front).round(3).tolist()
    [-0.021]
    >>> surface_transfer("shape-preserving", film, *at)(front).tolist()
    [0.0]
    """
    if kind == "spline":
        return SplineTransfer(source.first.cardinals(theta1), source.second.cardinals(theta2))
    return ShapePreservingTransfer(
        source.first.greville(), source.second.greville(), theta1, theta2
    )
