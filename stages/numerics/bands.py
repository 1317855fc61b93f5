"""Band matrices without symmetry (LAPACK's LU), and the elimination of tied unknowns from any band."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel
from stages.numerics.sparse import BandFactor, SingularMatrixError, SymmetricBand

TieTable: TypeAlias = tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], Array]
"""Slaves, starts, masters, factors, as in :class:`stages.numerics.ties.Ties`."""


@dataclass(frozen=True)
class GeneralBand:
    """Matrix of which as many sub- as superdiagonals are stored.

    Parameters
    ----------
    bands
        Column by column: ``bands[j, width + i - j] = A_ij`` for |i - j| <= width; shape
        ``(size, 2 width + 1)``. Its transpose is LAPACK's band storage, without a copy.

    Examples
    --------
    >>> matrix = GeneralBand(np.array([[0.0, 2.0, 1.0], [4.0, 3.0, 0.0]]))
    >>> matrix.dense().tolist()
    [[2.0, 4.0], [1.0, 3.0]]
    >>> matrix.factorise().solve(np.array([6.0, 4.0])).tolist()
    [1.0, 1.0]
    """

    bands: Array

    @classmethod
    def of(cls, symmetric: SymmetricBand) -> GeneralBand:
        """A symmetric matrix with both its triangles."""
        n, k = symmetric.size, symmetric.width
        bands = np.zeros((n, 2 * k + 1))
        bands[:, k:] = symmetric.bands
        for offset in range(1, min(k + 1, n)):
            bands[offset:, k - offset] = symmetric.bands[: n - offset, offset]
        return cls(bands)

    @property
    def size(self) -> int:
        """Number of rows."""
        return int(self.bands.shape[0])

    @property
    def width(self) -> int:
        """Number of subdiagonals."""
        return int(self.bands.shape[1]) // 2

    @property
    def diagonal(self) -> Array:
        """Diagonal, shape ``(size,)``."""
        return self.bands[:, self.width]

    def __matmul__(self, vector: Array) -> Array:
        n, k = self.size, self.width
        product = self.diagonal * vector
        for offset in range(1, min(k + 1, n)):
            product[offset:] += self.bands[: n - offset, k + offset] * vector[: n - offset]
            product[: n - offset] += self.bands[offset:, k - offset] * vector[offset:]
        return product

    def supported(self, fixed: NDArray[np.bool_]) -> GeneralBand:
        """The matrix with unit rows and columns where ``fixed``."""
        bands, n, k = self.bands.copy(), self.size, self.width
        bands[fixed] = 0.0
        for i in map(int, np.flatnonzero(fixed)):
            j = np.arange(max(i - k, 0), min(i + k + 1, n))
            bands[j, k + i - j] = 0.0
        bands[fixed, k] = 1.0
        return GeneralBand(bands)

    def widened(self, width: int) -> GeneralBand:
        """The same matrix, with room for more off-diagonals."""
        more = max(width - self.width, 0)
        return GeneralBand(np.pad(self.bands, ((0, 0), (more, more))))

    def symmetric_part(self) -> SymmetricBand:
        """(A + A^T)/2."""
        n, k = self.size, self.width
        bands = 0.5 * self.bands[:, k:]
        bands[:, 0] *= 2.0
        for offset in range(1, min(k + 1, n)):
            bands[: n - offset, offset] += 0.5 * self.bands[offset:, k - offset]
        return SymmetricBand(bands)

    def dense(self) -> Array:
        """The whole matrix, for tests and small problems."""
        n, k = self.size, self.width
        full = np.zeros((n, n))
        for j in range(n):
            i = np.arange(max(j - k, 0), min(j + k + 1, n))
            full[i, j] = self.bands[j, k + i - j]
        return full

    def factorise(self) -> BandFactor:
        """LU factors with pivoting.

        Raises
        ------
        SingularMatrixError
            If the matrix holds a NaN or an infinity, or has a zero pivot.
        """
        if not np.isfinite(self.bands).all():
            raise SingularMatrixError("the matrix holds values that are not finite")
        n, k = self.size, self.width
        storage = np.zeros((3 * k + 1, n), order="F")
        storage[k:] = self.bands.T
        factor, pivots, info = lapack.dgbtrf(storage, k, k)
        if info > 0:
            raise SingularMatrixError(f"the matrix is singular: pivot {info} of {n} is zero")
        return BandFactor(False, lambda b: lapack.dgbtrs(factor, k, k, b, pivots)[0])


Band: TypeAlias = SymmetricBand | GeneralBand
"""A tangent: symmetric, unless a load follows the film."""


def combined(first: tuple[float, Band], *others: tuple[float, SymmetricBand]) -> Band:
    """Sum of multiples of matrices of one bandwidth."""
    factor, matrix = first
    bands = factor * matrix.bands
    start = 0 if isinstance(matrix, SymmetricBand) else matrix.width
    for factor, other in others:
        bands[:, start:] += factor * other.bands
        for offset in range(1, start + 1):
            bands[offset:, start - offset] += factor * other.bands[: other.size - offset, offset]
    return type(matrix)(bands)


def tied(matrix: Band, ties: TieTable) -> Band:
    """T^T A T, with empty rows and columns for the slaves."""
    wide = matrix.widened(_width_after(matrix.size, matrix.width, ties))
    if isinstance(wide, SymmetricBand):
        _tie_symmetric(wide.bands, *ties)
    else:
        _tie_general(wide.bands, *ties)
    return wide


def _width_after(size: int, width: int, ties: TieTable) -> int:
    """Half bandwidth once the neighbours of every slave are neighbours of its masters too."""
    slaves, starts, masters, _ = ties
    rows = np.arange(size)
    low, high = np.maximum(rows - width, 0), np.minimum(rows + width, size - 1)
    for k, slave in enumerate(slaves):
        for master in masters[starts[k] : starts[k + 1]]:
            low[master] = min(low[master], low[slave])
            high[master] = max(high[master], high[slave])
            near = slice(low[slave], high[slave] + 1)
            low[near] = np.minimum(low[near], master)
            high[near] = np.maximum(high[near], master)
    return int(max((rows - low).max(), (high - rows).max()))


@kernel
def _tie_symmetric(a: Any, slaves: Any, starts: Any, masters: Any, factors: Any) -> None:
    """Slave by slave: the congruence u_s = u_s + sum_k c_k u_mk, and row and column s emptied."""
    n, width = a.shape[0], a.shape[1] - 1
    row = np.empty(n)
    for k in range(slaves.size):
        s = slaves[k]
        low, high = max(s - width, 0), min(s + width, n - 1)
        for j in range(low, high + 1):
            row[j] = a[j, s - j] if j <= s else a[s, j - s]
            if j <= s:
                a[j, s - j] = 0.0
            else:
                a[s, j - s] = 0.0
        for i in range(starts[k], starts[k + 1]):
            m, c = masters[i], factors[i]
            for j in range(low, high + 1):
                if j == s or row[j] == 0.0:
                    continue
                if j < m:
                    a[j, m - j] += c * row[j]
                elif j > m:
                    a[m, j - m] += c * row[j]
                else:
                    a[m, 0] += 2.0 * c * row[j]
            for other in range(starts[k], starts[k + 1]):
                if masters[other] <= m:
                    a[masters[other], m - masters[other]] += c * factors[other] * row[s]


@kernel
def _tie_general(a: Any, slaves: Any, starts: Any, masters: Any, factors: Any) -> None:
    """As above, with row and column of the slave apart."""
    n, width = a.shape[0], a.shape[1] // 2
    row, column = np.empty(n), np.empty(n)
    for k in range(slaves.size):
        s = slaves[k]
        low, high = max(s - width, 0), min(s + width, n - 1)
        for j in range(low, high + 1):
            row[j], column[j] = a[j, width + s - j], a[s, width + j - s]
            a[j, width + s - j], a[s, width + j - s] = 0.0, 0.0
        for i in range(starts[k], starts[k + 1]):
            m, c = masters[i], factors[i]
            for j in range(low, high + 1):
                if j != s and (row[j] != 0.0 or column[j] != 0.0):
                    a[j, width + m - j] += c * row[j]
                    a[m, width + j - m] += c * column[j]
            for other in range(starts[k], starts[k + 1]):
                a[masters[other], width + m - masters[other]] += c * factors[other] * row[s]
