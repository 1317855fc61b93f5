"""Gauss rules integrate polynomials exactly; patch grids are ordered as documented."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.numerics.patches import Patch
from stages.numerics.quadrature import gauss, moments, quadrature_grid
from tests.strategies import bumpy_patches, rational_patches


@pytest.mark.parametrize("points", range(1, 7))
def test_a_rule_of_n_points_is_exact_to_degree_2n_minus_1(points: int) -> None:
    x, w = gauss(points, -0.3, 1.7)
    for degree in range(2 * points):
        exact = (1.7 ** (degree + 1) - (-0.3) ** (degree + 1)) / (degree + 1)
        assert w @ x**degree == pytest.approx(exact, rel=1e-14)  # sums of at most six terms
    degree = 2 * points
    exact = (1.7 ** (degree + 1) - (-0.3) ** (degree + 1)) / (degree + 1)
    assert abs(w @ x**degree - exact) > 1e-6 * exact  # and no further: 1e-5 is missed by six points


def test_the_grid_of_a_patch_runs_element_by_element() -> None:
    patch = Patch.rectangle(3.5, 2.0).refine(2, (5, 2))
    grid = quadrature_grid(patch, 3)
    assert grid.theta1.shape == (15,)
    assert grid.theta2.shape == (6,)
    assert np.all(np.diff(grid.theta1) > 0)
    assert np.all((grid.theta1[:3] > 0) & (grid.theta1[:3] < 0.2))
    assert grid.weights1.sum() == pytest.approx(1.0, rel=1e-14)  # a sum of fifteen terms


@settings(deadline=None)
@given(st.one_of(bumpy_patches(), rational_patches()), st.sampled_from([(), (3,)]))
def test_moments_are_sums_over_points_of_the_functions(
    patch: Patch, shape: tuple[int, ...]
) -> None:
    grid = quadrature_grid(patch, 2)
    pairs = np.stack(np.meshgrid(grid.theta1, grid.theta2, indexing="ij"), axis=-1).reshape(-1, 2)
    density = np.random.default_rng(6).normal(size=(len(pairs), *shape))
    expected = np.einsum("pc,p...->c...", patch.functions(pairs), density)
    # the same sums in another order
    np.testing.assert_allclose(moments(patch, grid, density), expected, rtol=0, atol=1e-13)


def test_no_points_make_no_rule() -> None:
    with pytest.raises(ValueError, match="0 points"):
        gauss(0)
