"""Dead loads: nodal forces that keep their direction and size (eq. 47)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stages.mechanics.actions.edges import edge_integrals
from stages.mechanics.actions.points import functions_at, functions_over
from stages.numerics.bands import GeneralBand
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.quadrature import moments, quadrature_grid
from stages.numerics.surface_geometry import frame_on_grid


@dataclass(frozen=True)
class DeadForce:
    """Nodal forces F, whatever the shape; they have the potential -F . u."""

    nodal: Array

    @property
    def follows(self) -> bool:
        """No."""
        return False

    def at(self, position: Array) -> Array:
        """F, kPa mm^2, shape ``(dof,)``."""
        return self.nodal

    def add_stiffness(self, position: Array, factor: float, matrix: GeneralBand) -> None:
        """Nothing."""


def over_area(patch: Patch, vector: tuple[float, float, float], points: int) -> DeadForce:
    """F_I = integral of N_I q over the undeformed film, q in kPa; ``points`` per span and direction."""
    grid = quadrature_grid(patch, points)
    area = frame_on_grid(patch, grid.theta1, grid.theta2).area
    weights = np.outer(grid.weights1, grid.weights2).ravel() * area
    return DeadForce(np.outer(moments(patch, grid, weights), vector).ravel())


def along_edge(
    patch: Patch, edge: str, vector: tuple[float, float, float], points: int
) -> DeadForce:
    """F_I = integral of N_I t along an edge of the undeformed film, t in kPa mm."""
    return DeadForce(np.outer(edge_integrals(patch, edge, points), vector).ravel())


def at_position(
    patch: Patch, position: tuple[float, float], vector: tuple[float, float, float]
) -> DeadForce:
    """F_I = N_I P at the point over (X, Y), P in kPa mm^2."""
    return DeadForce(np.outer(functions_over(patch, position), vector).ravel())


def at_parameters(
    patch: Patch, parameters: tuple[float, float], vector: tuple[float, float, float]
) -> DeadForce:
    """F_I = N_I P at the parameters (theta1, theta2), P in kPa mm^2."""
    return DeadForce(np.outer(functions_at(patch, parameters), vector).ravel())
