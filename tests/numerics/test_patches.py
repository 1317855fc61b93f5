"""Patches keep points and parametrisation under refinement; the nearest point is found."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.numerics.patches import Patch, interpolate_grid
from stages.numerics.surface_geometry import locate
from tests.problems import parabolic_sheet, skewed_square
from tests.strategies import bumpy_patches


@settings(deadline=None)
@given(bumpy_patches(), st.integers(0, 1), st.integers(1, 2))
def test_refinement_moves_no_point(patch: Patch, raised: int, split: int) -> None:
    elements = (patch.first.elements * split, patch.second.elements * split)
    degree = max(patch.first.degree, patch.second.degree) + raised
    finer = patch.refine(degree, elements)
    theta = [np.linspace(s.knots[0], s.knots[-1], 7) for s in patch.spaces]
    # coordinates up to 12, through two interpolations: a hundred roundings of 1e-15 at most
    np.testing.assert_allclose(finer.evaluate(*theta), patch.evaluate(*theta), rtol=0, atol=1e-12)


@settings(deadline=None)
@given(bumpy_patches())
def test_grid_and_scattered_evaluation_agree(patch: Patch) -> None:
    theta = [np.linspace(s.knots[0], s.knots[-1], 5) for s in patch.spaces]
    pairs = np.stack(np.meshgrid(*theta, indexing="ij"), axis=-1).reshape(-1, 2)
    for orders in ((0, 0), (1, 0), (1, 1), (0, 2)):
        np.testing.assert_array_equal(
            patch.evaluate(*theta, orders).shape, patch.evaluate_points(pairs, orders).shape
        )
        # the same sums in another order; two derivatives over spans of 0.2 enlarge round-off by 1e2
        np.testing.assert_allclose(
            patch.evaluate(*theta, orders), patch.evaluate_points(pairs, orders), rtol=0, atol=1e-11
        )


@settings(deadline=None)
@given(bumpy_patches())
def test_interpolation_at_the_greville_points_gives_the_control_net_back(patch: Patch) -> None:
    greville = (patch.first.greville(), patch.second.greville())
    grid = patch.evaluate(*greville).reshape(patch.control_points.shape)
    # round-off of coordinates up to 12, times a condition of interpolation below 1e2
    np.testing.assert_allclose(
        interpolate_grid(patch.spaces, grid), patch.control_points, rtol=0, atol=1e-12
    )


@pytest.mark.parametrize(
    "patch", [Patch.rectangle(3.5, 2.0), parabolic_sheet(1.5, 3.5, 2.0), skewed_square()]
)
def test_a_point_of_the_surface_is_located(patch: Patch) -> None:
    theta = np.random.default_rng(7).uniform(0, 1, (20, 2))
    theta[:2] = [[0, 0], [1, 1]]
    found = locate(patch.refine(2, (8, 4)), patch.evaluate_points(theta))
    # Gauss-Newton stops at round-off of positions of size 4
    np.testing.assert_allclose(found, theta, rtol=0, atol=1e-13)


def test_a_point_off_the_film_is_refused() -> None:
    with pytest.raises(ValueError, match=r"does not lie on the film.*0\.5 mm away"):
        locate(Patch.rectangle(3.5, 2.0), np.array([[4.0, 1.0, 0.0]]))


def test_a_net_of_the_wrong_shape_is_refused() -> None:
    flat = Patch.rectangle(1.0, 1.0)
    with pytest.raises(ValueError, match="does not fit spaces of 2 x 2"):
        Patch(flat.first, flat.second, np.zeros((3, 2, 3)))
