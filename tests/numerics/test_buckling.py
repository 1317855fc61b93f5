"""Buckling loads against Euler's column, and the softest modes against dense algebra."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.buckling import NoModesError, buckling_modes, softest_modes
from stages.numerics.quadrature import gauss_on_spans
from stages.numerics.sparse import SymmetricBand
from tests.numerics.test_sparse import random_band


def column(elements: int, load: float = 1.0) -> tuple[SymmetricBand, SymmetricBand, Array]:
    """Hinged column of length 1 and bending stiffness 1: K0 and K0 - load G, cubic splines."""
    space = SplineSpace.uniform(3, elements)
    points, weights = (x.ravel() for x in gauss_on_spans(space.breaks, 4))
    first, second = space.evaluate(points, 1), space.evaluate(points, 2)
    bend = second.T @ (weights[:, None] * second)
    shorten = first.T @ (weights[:, None] * first)
    free = np.ones(space.size, dtype=bool)
    free[[0, -1]] = False
    return _band(bend), _band(bend - load * shorten), free


def _band(dense: Array) -> SymmetricBand:
    bands = np.zeros((dense.shape[0], 4))
    for offset in range(4):
        bands[: dense.shape[0] - offset, offset] = np.diagonal(dense, -offset)
    return SymmetricBand(bands)


@pytest.mark.parametrize("elements", [16, 100])
def test_a_hinged_column_buckles_at_eulers_loads(elements: int) -> None:
    """P_n = (n pi)^2; 16 elements take the dense way, 100 take Lanczos'."""
    k0, k1, free = column(elements, load=2.5)
    modes = buckling_modes(k0, k0.supported(~free).factorise().solve, k1, free, 3)
    # cubics: the relative error of the n-th load is close to (n pi h)^4 / 700
    expected = (np.arange(1, 4) * np.pi) ** 2 / 2.5
    np.testing.assert_allclose(modes.values, expected, rtol=(3 * np.pi / elements) ** 4 / 500)
    assert not modes.shapes[:, ~free].any()
    for value, shape in zip(modes.values, modes.shapes, strict=True):
        assert shape @ (k0 @ shape) == pytest.approx(1.0)
        residual = (k0 @ shape + value * (k1 @ shape - k0 @ shape))[free]
        assert np.abs(residual).max() < 1e-8 * np.abs(k0 @ shape).max()


def test_pulled_instead_of_pressed_the_factors_are_negative() -> None:
    k0, k1, free = column(16, load=-1.0)
    modes = buckling_modes(k0, k0.supported(~free).factorise().solve, k1, free, 1)
    assert modes.values[0] == pytest.approx(-(np.pi**2), rel=1e-3)


def test_a_load_without_effect_buckles_nothing() -> None:
    k0, _, free = column(16)
    with pytest.raises(NoModesError, match="changes the stiffness in fewer directions"):
        buckling_modes(k0, k0.supported(~free).factorise().solve, k0, free, 1)


@pytest.mark.parametrize("size", [20, 150])
def test_the_softest_modes_are_those_of_the_dense_matrix(size: int) -> None:
    matrix = random_band(size, 4, 0.3, seed=5)  # indefinite
    free = np.ones(size, dtype=bool)
    free[[0, 7]] = False
    modes = softest_modes(matrix, matrix.supported(~free).factorise().solve, free, 3)
    exact = np.linalg.eigvalsh(matrix.dense()[np.ix_(free, free)])
    exact = exact[np.argsort(np.abs(exact))][:3]
    np.testing.assert_allclose(modes.values, exact, rtol=1e-8)
    assert not modes.shapes[:, ~free].any()
    np.testing.assert_allclose(np.linalg.norm(modes.shapes, axis=1), 1.0, rtol=1e-12)


def test_more_modes_than_unknowns_are_refused() -> None:
    matrix = random_band(5, 1, 3.0)
    free = np.array([True, True, False, False, False])
    with pytest.raises(NoModesError, match="3 modes were asked for, but there are 2"):
        softest_modes(matrix, matrix.factorise().solve, free, 3)
