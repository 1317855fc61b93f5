"""Potential at the edges from the one inside: what fulfils the given flux.

At the edges the equation is D n.grad v = I_n alone (eq. 76), so that their values follow from those at
interior points. The cells' half step at the end of a splitting moves all points by their own rates, after which the
edges no longer take a flux that acts: by half a step's worth of rates, a first-order error. Put back, they lose no order.

The collocated edges jump with the flux. So that their stress sees no potential from before a jump, it follows the
potential with the mean flux of the step at both ends; the level itself then takes the flux at its time.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from stages.electrophysiology.diffusion import factorise
from stages.electrophysiology.modes import Modes
from stages.electrophysiology.tissue import Problem
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators
from stages.numerics.compiled import kernel


@dataclass(frozen=True)
class EdgeValues:
    """Edges of any patch, seams included.

    Attributes
    ----------
    solver
        Factors of the matrix with N at interior points, n.grad on the edges.
    values
        Interpolation matrix, shape ``(point, control)``.
    inside
        1 at interior points, 0 on the edges.
    lifts
        What the flux of each stimulus at full strength adds at the edges, mV; zero inside, shape
        ``(stimulus, point)``.
    """

    solver: SuperLU
    values: sparse.csr_array
    inside: Array
    lifts: Array

    def close(self, potential: Array) -> None:
        """Change the potential at the edges, mV, in place so that nothing flows."""
        control = self.solver.solve(self.inside * potential)
        potential[:] = np.where(self.inside > 0.0, potential, self.values @ control)


def edge_values(problem: Problem, operators: CollocationOperators) -> EdgeValues | None:
    """The edges of a problem; None where no stimulus drives a flux through them."""
    fluxes = np.array([source.boundary / problem.conductivity for source in problem.sources])
    if not fluxes.any():
        return None
    inside = operators.interior.astype(float)
    solver = factorise(sparse.diags_array(inside) @ operators.values + operators.flux)
    lifts = [(1.0 - inside) * (operators.values @ solver.solve(flux)) for flux in fluxes]
    return EdgeValues(solver, operators.values, inside, np.array(lifts))


def end_rows(modes: Modes) -> Array:
    """Values at both ends of a direction from those at its points, without flux, shape ``(2, point)``."""
    return np.ascontiguousarray((modes.to_points @ modes.from_points)[[0, -1]])


@kernel
def close_edges(grid: Any, ends1: Any, ends2: Any) -> None:
    """Change the edges of a grid of potentials in place so that nothing flows; see :func:`end_rows`."""
    last1, last2 = grid.shape[0] - 1, grid.shape[1] - 1
    rows = np.dot(ends1, grid)
    grid[0, 1:last2], grid[last1, 1:last2] = rows[0, 1:last2], rows[1, 1:last2]
    columns = np.dot(ends2, grid.T.copy())
    grid[:, 0], grid[:, last2] = columns[0], columns[1]
