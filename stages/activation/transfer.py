"""From collocation points to shell quadrature points (eqs. 86-87)."""

from __future__ import annotations

from dataclasses import dataclass

from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch


@dataclass(frozen=True)
class SurfaceTransfer:
    """Values at the Greville points of one patch to values on a tensor grid of parameters.

    The spline through the collocated values (eq. 86), evaluated at the grid (eq. 87); in one
    direction after the other, each a small dense matrix ``(grid, n)``.
    """

    first: Array
    second: Array

    @classmethod
    def between(cls, source: Patch, theta1: Array, theta2: Array) -> SurfaceTransfer:
        """Transfer from the Greville points of ``source`` to ``theta1`` x ``theta2``."""
        return cls(source.first.cardinals(theta1), source.second.cardinals(theta2))

    def __call__(self, values: Array) -> Array:
        """Shape ``(point,)`` to shape ``(grid point,)``, direction 2 fastest on both sides."""
        grid = values.reshape(self.first.shape[1], self.second.shape[1])
        return (self.first @ grid @ self.second.T).ravel()
