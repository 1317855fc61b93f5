"""Signs of the pivots of a symmetric band matrix: how many directions are unstable."""

from __future__ import annotations

from typing import Any

import numpy as np

from stages.numerics.compiled import kernel
from stages.numerics.sparse import SymmetricBand


def negative_pivots(matrix: SymmetricBand) -> int:
    """Number of negative eigenvalues, by Sylvester's law of inertia: A = L D L^T.

    The factorisation takes the pivots in order, without exchanges, so that it stays in the band. A
    pivot that vanishes is taken as a tiny positive one: the matrix is singular then, and the count is
    that of a neighbour of it.

    Examples
    --------
    >>> negative_pivots(SymmetricBand(np.array([[1.0, 2.0], [1.0, 0.0]])))  # eigenvalues 3 and -1
    1
    """
    scale = float(np.abs(matrix.bands).max(initial=0.0))
    return int(_negative_pivots(matrix.bands.copy(), np.finfo(float).tiny + 1e-300 * scale))


@kernel
def _negative_pivots(a: Any, tiny: float) -> int:
    """Right-looking elimination in place; ``a[j, i - j] = A_ij`` for i >= j."""
    n, width = a.shape[0], a.shape[1] - 1
    negative = 0
    for j in range(n):
        pivot = a[j, 0]
        if pivot < 0.0:
            negative += 1
        elif pivot < tiny:
            pivot = tiny
        for k in range(1, min(width, n - 1 - j) + 1):
            factor = a[j, k] / pivot
            if factor != 0.0:
                for m in range(k, width + 1):
                    a[j + k, m - k] -= factor * a[j, m]
    return negative
