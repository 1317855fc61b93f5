"""Symmetric band matrices: products, supports, Cholesky with an LU fallback (LAPACK)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import blas, lapack

from stages.numerics.bsplines import Array


class SingularMatrixError(Exception):
    """A matrix has no inverse, to working precision, or is not finite."""


@dataclass(frozen=True)
class SymmetricBand:
    """Symmetric matrix of which only a band is stored.

    Parameters
    ----------
    bands
        Lower triangle, column by column: ``bands[j, i - j] = A_ij`` for ``j <= i <= j + width``; shape
        ``(size, width + 1)``. Its transpose is LAPACK's lower band storage, without a copy.

    Examples
    --------
    >>> spring = SymmetricBand(np.array([[2.0, -1.0], [2.0, -1.0], [1.0, 0.0]]))
    >>> spring.dense().tolist()
    [[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]
    >>> spring.factorise().solve(np.array([0.0, 0.0, 1.0])).round(12).tolist()
    [1.0, 2.0, 3.0]
    """

    bands: Array

    @classmethod
    def zeros(cls, size: int, width: int) -> SymmetricBand:
        """Zero matrix with ``width`` subdiagonals."""
        return cls(np.zeros((size, width + 1)))

    @property
    def size(self) -> int:
        """Number of rows."""
        return int(self.bands.shape[0])

    @property
    def width(self) -> int:
        """Number of subdiagonals."""
        return int(self.bands.shape[1]) - 1

    @property
    def diagonal(self) -> Array:
        """Diagonal, shape ``(size,)``."""
        return self.bands[:, 0]

    def __matmul__(self, vector: Array) -> Array:
        product = blas.dsbmv(self.width, 1.0, self.bands.T, vector, lower=1)
        return np.asarray(product)

    def __add__(self, other: SymmetricBand) -> SymmetricBand:
        return SymmetricBand(self.bands + other.bands)

    def scaled(self, factor: float) -> SymmetricBand:
        """The matrix times a number."""
        return SymmetricBand(factor * self.bands)

    def supported(self, fixed: NDArray[np.bool_]) -> SymmetricBand:
        """The matrix with unit rows and columns where ``fixed``: those unknowns stay put."""
        bands = self.bands.copy()
        bands[fixed] = 0.0
        bands[fixed, 0] = 1.0
        for j in np.flatnonzero(fixed):
            reach = min(int(j), self.width)
            offsets = np.arange(1, reach + 1)
            bands[j - offsets, offsets] = 0.0
        return SymmetricBand(bands)

    def widened(self, width: int) -> SymmetricBand:
        """The same matrix, with room for more subdiagonals."""
        return SymmetricBand(np.pad(self.bands, ((0, 0), (0, max(width - self.width, 0)))))

    def symmetric_part(self) -> SymmetricBand:
        """The matrix itself."""
        return self

    def dense(self) -> Array:
        """The whole matrix, for tests and small problems."""
        full = np.zeros((self.size, self.size))
        for offset in range(min(self.width + 1, self.size)):
            values = self.bands[: self.size - offset, offset]
            rows = np.arange(self.size - offset)
            full[rows + offset, rows] = values
            full[rows, rows + offset] = values
        return full

    def factorise(self) -> BandFactor:
        """Cholesky factors, or LU factors with pivoting where the matrix is not positive definite.

        Raises
        ------
        SingularMatrixError
            If the matrix holds a NaN or an infinity, or has a zero pivot.
        """
        if not np.isfinite(self.bands).all():
            raise SingularMatrixError("the matrix holds values that are not finite")
        factor, info = lapack.dpbtrf(self.bands.T, lower=1)
        if info == 0:
            return BandFactor(True, lambda b: lapack.dpbtrs(factor, b, lower=1)[0])
        return self._lu()

    def _lu(self) -> BandFactor:
        n, k = self.size, self.width
        storage = np.zeros((3 * k + 1, n), order="F")
        for offset in range(min(k + 1, n)):
            values = self.bands[: n - offset, offset]
            storage[2 * k + offset, : n - offset] = values
            storage[2 * k - offset, offset:] = values
        factor, pivots, info = lapack.dgbtrf(storage, k, k)
        if info > 0:
            raise SingularMatrixError(f"the matrix is singular: pivot {info} of {n} is zero")
        return BandFactor(False, lambda b: lapack.dgbtrs(factor, k, k, b, pivots)[0])


@dataclass(frozen=True)
class BandFactor:
    """Factors of a symmetric band matrix.

    Attributes
    ----------
    positive_definite
        Whether Cholesky's method went through; a tangent that fails has an unstable direction.
    solve
        Solution of A x = b.
    """

    positive_definite: bool
    solve: Callable[[Array], Array]
