"""From values at the Gauss points of a patch to the spline nearest to them, direction by direction."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.quadrature import gauss_on_spans


@dataclass(frozen=True)
class GaussProjection:
    """L2 projection of a field known at the in-plane Gauss points onto a patch's splines, evaluated.

    The spline s minimises the weighted squares of s - f over the Gauss points of the parameters. The
    weights are products, so the projection is one small matrix ``(evaluation points, Gauss points)``
    per direction.

    Attributes
    ----------
    first, second
        Matrices of both directions.
    """

    first: Array
    second: Array

    @classmethod
    def onto(cls, patch: Patch, values: int, theta1: Array, theta2: Array) -> GaussProjection:
        """Projection of fields of so many values, to be evaluated at ``theta1`` and at ``theta2``.

        Raises
        ------
        ValueError
            If the values do not fill equal Gauss rules of all elements.
        """
        elements = patch.first.elements * patch.second.elements
        points = math.isqrt(values // elements)
        if points * points * elements != values:
            raise ValueError(
                f"a field of {values} values does not belong to Gauss points of "
                f"{patch.first.elements} x {patch.second.elements} elements"
            )
        return cls(_matrix(patch.first, points, theta1), _matrix(patch.second, points, theta2))

    def on_grid(self, values: Array) -> Array:
        """Field at the tensor grid of the parameters, shape ``(n1, n2)``, from ``(Gauss point,)``."""
        grid = values.reshape(self.first.shape[1], self.second.shape[1])
        return np.asarray(self.first @ grid @ self.second.T)

    def at_points(self) -> Array:
        """Matrix ``(n, Gauss point)`` for the pairs of parameters, of which there are n each."""
        tensor = np.einsum("pi,pj->pij", self.first, self.second)
        return tensor.reshape(len(self.first), -1)


def _matrix(space: SplineSpace, points: int, at: Array) -> Array:
    gauss, weights = (part.ravel() for part in gauss_on_spans(space.breaks, points))
    basis = space.evaluate(gauss)
    mass = basis.T @ (weights[:, None] * basis)
    return np.asarray(space.evaluate(at) @ np.linalg.solve(mass, basis.T * weights))
