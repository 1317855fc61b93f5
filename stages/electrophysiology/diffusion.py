"""The Crank-Nicolson diffusion step of eqs. 79-84 on any patch.

It solves A v_new = b with, in interior rows, A = N - c Lap and b = (N + c Lap) v_old + source, where
c = step D / (2 C_m), and in boundary rows D n.grad v = I_n.
"""

from __future__ import annotations

from dataclasses import dataclass

from scipy import sparse
from scipy.sparse.linalg import SuperLU, splu

from stages.numerics.collocation import CollocationOperators


@dataclass(frozen=True)
class SparseDiffusion:
    """Factorised system of any patch: a sparse LU solve each step."""

    solver: SuperLU
    explicit: sparse.csr_array
    """N + c Lap in interior rows, zero in boundary rows, shape ``(point, control)``."""
    values: sparse.csr_array


def system_matrix(
    operators: CollocationOperators, diffusivity: float, step: float
) -> sparse.csc_array:
    """A of eq. 83 over C_m: N - c Lap inside, n.grad on the boundary (eq. 76 over D)."""
    inside = sparse.diags_array(operators.interior.astype(float))
    matrix = inside @ (operators.values - 0.5 * step * diffusivity * operators.laplacian)
    return sparse.csc_array(matrix + operators.flux)


def sparse_diffusion(
    operators: CollocationOperators, diffusivity: float, step: float
) -> SparseDiffusion:
    """Solver for any patch. ``diffusivity`` is D/C_m in mm^2/ms, ``step`` in ms."""
    inside = sparse.diags_array(operators.interior.astype(float))
    explicit = inside @ (operators.values + 0.5 * step * diffusivity * operators.laplacian)
    return SparseDiffusion(
        splu(system_matrix(operators, diffusivity, step)),
        sparse.csr_array(explicit),
        operators.values,
    )
