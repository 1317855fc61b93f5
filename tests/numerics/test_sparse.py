"""Symmetric bands against dense algebra."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.sparse import SingularMatrixError, SymmetricBand


def random_band(size: int, width: int, shift: float, seed: int = 0) -> SymmetricBand:
    """Entries in [-1, 1], plus ``shift`` on the diagonal; zero where the band leaves the matrix."""
    bands = np.random.default_rng(seed).uniform(-1, 1, (size, width + 1))
    for offset in range(1, width + 1):
        bands[size - offset :, offset] = 0.0
    bands[:, 0] += shift
    return SymmetricBand(bands)


SIZES = [(12, 3), (5, 4), (4, 0), (40, 17)]


@pytest.mark.parametrize(("size", "width"), SIZES)
def test_products_equal_those_of_the_dense_matrix(size: int, width: int) -> None:
    matrix = random_band(size, width, 0.0)
    x = np.random.default_rng(1).normal(size=size)
    np.testing.assert_allclose(matrix @ x, matrix.dense() @ x, rtol=1e-13, atol=1e-13)
    np.testing.assert_array_equal(matrix.dense(), matrix.dense().T)


@pytest.mark.parametrize(("size", "width"), SIZES)
def test_a_positive_definite_matrix_is_solved_by_cholesky(size: int, width: int) -> None:
    matrix = random_band(size, width, 2.0 * width + 2.0)  # diagonally dominant
    x = np.random.default_rng(2).normal(size=size)
    factor = matrix.factorise()
    assert factor.positive_definite
    # condition numbers are below 1e2
    np.testing.assert_allclose(factor.solve(matrix.dense() @ x), x, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(("size", "width"), SIZES)
def test_an_indefinite_matrix_is_solved_and_says_that_it_is_indefinite(
    size: int, width: int
) -> None:
    matrix = random_band(size, width, 0.0, seed=3)
    matrix.bands[0, 0] = -3.0
    x = np.random.default_rng(4).normal(size=size)
    factor = matrix.factorise()
    assert not factor.positive_definite
    # condition numbers here are below 1e4
    np.testing.assert_allclose(factor.solve(matrix.dense() @ x), x, rtol=1e-10, atol=1e-10)


def test_supported_unknowns_stay_put_and_the_others_do_not_feel_them() -> None:
    matrix = random_band(12, 3, 8.0)
    fixed = np.zeros(12, dtype=bool)
    fixed[[0, 1, 5, 11]] = True
    load = np.where(fixed, 0.0, 1.0)
    x = matrix.supported(fixed).factorise().solve(load)
    free = ~fixed
    assert not x[fixed].any()
    expected = np.linalg.solve(matrix.dense()[np.ix_(free, free)], load[free])
    np.testing.assert_allclose(x[free], expected, rtol=1e-12)


def test_the_matrix_survives_its_factorisation() -> None:
    matrix = random_band(12, 3, 8.0)
    before = matrix.bands.copy()
    matrix.factorise().solve(np.ones(12))
    np.testing.assert_array_equal(matrix.bands, before)


def test_a_singular_matrix_is_named() -> None:
    with pytest.raises(SingularMatrixError, match="pivot 1 of 4 is zero"):
        SymmetricBand.zeros(4, 2).factorise()


def test_a_matrix_with_a_nan_is_refused() -> None:
    matrix = random_band(6, 2, 8.0)
    matrix.bands[2, 1] = np.nan
    with pytest.raises(SingularMatrixError, match="not finite"):
        matrix.factorise()
