"""Pressure that stays normal to the film as it deforms.

    F_I = integral of N_I r_,1 x r_,2,    dF_I/du_J = integral of N_I (N_J,2 [r_,1] - N_J,1 [r_,2])

over the parameters, with [a] b = a x b: per area of the deformed film, along a_3. The derivative is
symmetric where the boundary is held or the surface is closed, since the force then has a potential (the
volume); in general it is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stages.mechanics.shell.discretisation import (
    Basis,
    basis_on_grid,
    shape_derivatives,
    shape_values,
)
from stages.numerics.bands import GeneralBand
from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel
from stages.numerics.patches import Patch


@dataclass(frozen=True)
class Pressure:
    """Pressure of 1 kPa along the normal a_3 of the deformed film."""

    basis: Basis
    weights: Array

    @classmethod
    def on(cls, patch: Patch) -> Pressure:
        """With as many Gauss points as integrate polynomials of degree 3p - 1 exactly."""
        degree = max(space.degree for space in patch.spaces)
        return cls(*basis_on_grid(patch, -(-3 * degree // 2)))

    @property
    def follows(self) -> bool:
        """Yes."""
        return True

    def at(self, position: Array) -> Array:
        """F, kPa mm^2, shape ``(dof,)``."""
        force = np.zeros(position.shape)
        _add_force(self.basis, self.weights, np.ascontiguousarray(position), force)
        return force.ravel()

    def add_stiffness(self, position: Array, factor: float, matrix: GeneralBand) -> None:
        """Add ``factor`` dF/du."""
        position = np.ascontiguousarray(position)
        _add_stiffness(self.basis, self.weights, position, factor, matrix.width, matrix.bands)

    def volume(self, position: Array) -> float:
        """Volume between the film and the origin, integral of r . (r_,1 x r_,2)/3, mm^3."""
        return float(self.at(position) @ position.ravel()) / 3.0


@kernel
def _tangents(shapes: Any, corner: int, basis: Any, position: Any, a: Any) -> None:
    """r_,1 and r_,2 into ``a`` (2, 3)."""
    columns = basis.values2.shape[2]
    a[:] = 0.0
    for k in range(shapes.shape[1]):
        c = corner + (k // columns) * basis.columns + k % columns
        for x in range(3):
            a[0, x] += shapes[0, k] * position[c, x]
            a[1, x] += shapes[1, k] * position[c, x]


@kernel
def _add_force(basis: Any, weights: Any, position: Any, force: Any) -> None:
    q, columns = basis.points, basis.values2.shape[2]
    local = basis.values1.shape[2] * columns
    shape, shapes, a = np.empty(local), np.empty((5, local)), np.empty((2, 3))
    for g1 in range(basis.values1.shape[0]):
        for g2 in range(basis.values2.shape[0]):
            corner = basis.first1[g1 // q] * basis.columns + basis.first2[g2 // q]
            shape_values(basis, g1, g2, shape)
            shape_derivatives(basis, g1, g2, shapes)
            _tangents(shapes, corner, basis, position, a)
            w = weights[g1 * basis.values2.shape[0] + g2]
            n0 = w * (a[0, 1] * a[1, 2] - a[0, 2] * a[1, 1])
            n1 = w * (a[0, 2] * a[1, 0] - a[0, 0] * a[1, 2])
            n2 = w * (a[0, 0] * a[1, 1] - a[0, 1] * a[1, 0])
            for k in range(local):
                c = corner + (k // columns) * basis.columns + k % columns
                force[c, 0] += shape[k] * n0
                force[c, 1] += shape[k] * n1
                force[c, 2] += shape[k] * n2


@kernel
def _add_stiffness(
    basis: Any, weights: Any, position: Any, factor: float, width: int, bands: Any
) -> None:
    """Entry (I x, J y) of [v] is v_z where (x, y, z) runs against the cycle, -v_z where with it."""
    q, columns = basis.points, basis.values2.shape[2]
    local = basis.values1.shape[2] * columns
    shape, shapes, a = np.empty(local), np.empty((5, local)), np.empty((2, 3))
    v = np.empty(3)
    for g1 in range(basis.values1.shape[0]):
        for g2 in range(basis.values2.shape[0]):
            corner = basis.first1[g1 // q] * basis.columns + basis.first2[g2 // q]
            shape_values(basis, g1, g2, shape)
            shape_derivatives(basis, g1, g2, shapes)
            _tangents(shapes, corner, basis, position, a)
            w = factor * weights[g1 * basis.values2.shape[0] + g2]
            for j in range(local):
                column = 3 * (corner + (j // columns) * basis.columns + j % columns)
                for x in range(3):
                    v[x] = w * (shapes[1, j] * a[0, x] - shapes[0, j] * a[1, x])
                for i in range(local):
                    row = 3 * (corner + (i // columns) * basis.columns + i % columns)
                    for x in range(3):
                        y, z = (x + 1) % 3, (x + 2) % 3
                        value = shape[i] * v[z]
                        bands[column + y, width + row + x - column - y] -= value
                        bands[column + x, width + row + y - column - x] += value
