"""Diffusion over one step by an L-stable Runge-Kutta method, with flux and current constant over the step.

Two stages, both with the matrix A = N - gamma tau Lap in interior rows and n.grad in boundary rows
(tau = step D/C_m, gamma = 1 - 1/sqrt(2)):

    A c1 = N v + gamma step i,     A c = N v + (1 - gamma)/gamma (N c1 - N v) + gamma step i    inside,
    n.grad c1 = n.grad c = flux / D                                                   on the boundary,

where i is the applied current over C_m. Only values at interior points enter: a flux that jumps needs no
projection, since the edges take the data of the step at once. What is far too fast for the step is damped out,
which the Crank-Nicolson method would leave alternating.

References
----------
Alexander (1977), SIAM J. Numer. Anal. 14, 1006.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from stages.electrophysiology.diffusion import factorise
from stages.electrophysiology.modes import Complex
from stages.electrophysiology.tissue import Problem
from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)


def amplification(z: Complex) -> Complex:
    """By what a mode of rate z/tau grows in one step: exp(z) to second order, 0 for z = -infinity.

    Examples
    --------
    >>> float(amplification(-0.01) - math.exp(-0.01)) < 1e-7
    True
    >>> abs(amplification(-1e9)) < 1e-8
    True
    """
    return (1.0 + (1.0 - 2.0 * GAMMA) * z) / (1.0 - GAMMA * z) ** 2


@dataclass(frozen=True)
class LStableDiffusion:
    """One step of diffusion on any patch.

    Attributes
    ----------
    solver
        Factors of A.
    values
        Interpolation matrix, shape ``(point, control)``.
    inside
        1 at interior points, 0 on the boundary.
    tau
        step D/C_m, mm^2.
    responses
        What each stimulus at full strength adds in one step, mV, shape ``(stimulus, point)``.
    """

    solver: SuperLU
    values: sparse.csr_array
    inside: Array
    tau: float
    responses: Array

    def __call__(self, potential: Array, boundary: Array, current: Array) -> Array:
        """Potential at all points after the step, mV.

        Parameters
        ----------
        potential
            mV, shape ``(point,)``; only interior points count.
        boundary
            Flux over D in boundary rows, mV/mm; 0 inside.
        current
            gamma step I_app/C_m in interior rows, mV; 0 on the boundary.
        """
        start = self.inside * potential
        stage = self.values @ self.solver.solve(start + current + boundary)
        change = (1.0 - GAMMA) / GAMMA * (self.inside * stage - start)
        return np.asarray(
            self.values @ self.solver.solve(start + change + current + boundary), dtype=float
        )


def l_stable_diffusion(problem: Problem, operators: CollocationOperators) -> LStableDiffusion:
    """The step of a problem on a patch, with the responses to its stimuli."""
    tau, inside = problem.step * problem.diffusivity, operators.interior.astype(float)
    matrix = sparse.diags_array(inside) @ (operators.values - GAMMA * tau * operators.laplacian)
    solver = factorise(matrix + operators.flux)
    points, sources = inside.size, problem.sources
    step = LStableDiffusion(solver, operators.values, inside, tau, np.zeros((0, points)))
    applied = GAMMA * problem.step * problem.applied(inside)
    responses = [
        step(np.zeros(points), source.boundary / problem.conductivity, current)
        for source, current in zip(sources, applied, strict=True)
    ]
    return LStableDiffusion(
        solver, operators.values, inside, tau, np.reshape(responses, (len(sources), points))
    )
