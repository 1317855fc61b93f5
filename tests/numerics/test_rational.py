"""Rational patches: quotient rule, refinement, interpolation, storage, and what weights may be."""

from __future__ import annotations

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pipeline import codecs
from stages.artefacts import MidSurface
from stages.numerics.patches import Patch
from stages.numerics.shapes import cylindrical_panel, spherical_panel
from stages.numerics.surface_geometry import offset
from tests.strategies import bumpy_patches, rational_patches

ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def parameters(patch: Patch, count: int = 12) -> np.ndarray:
    theta = np.random.default_rng(2).uniform(0.05, 0.95, (count, 2))
    return theta * [patch.first.knots[-1], patch.second.knots[-1]]


@settings(deadline=None)
@given(rational_patches())
def test_derivatives_are_those_of_finite_differences(patch: Patch) -> None:
    """Each order against the central difference of the order below it."""
    theta, step = parameters(patch), 1e-5
    for orders, direction in product(ORDERS[:3], (0, 1)):
        ahead, behind = theta.copy(), theta.copy()
        ahead[:, direction] += step
        behind[:, direction] -= step
        whole = np.all(
            [s.span(ahead[:, k]) == s.span(behind[:, k]) for k, s in enumerate(patch.spaces)],
            axis=0,
        )
        higher = (orders[0] + (direction == 0), orders[1] + (direction == 1))
        slope = patch.evaluate_points(ahead, orders) - patch.evaluate_points(behind, orders)
        exact = patch.evaluate_points(theta, higher)
        # truncation step^2/6 times third derivatives of up to 1e5 (spans of 0.2, weights 1 to 4), and
        # round-off 1e-13 / step
        scale = 1.0 + np.abs(exact).max()
        assert np.abs((slope / (2 * step) - exact)[whole]).max(initial=0.0) < 1e-5 * scale


@settings(deadline=None)
@given(rational_patches())
def test_grid_points_scattered_points_and_functions_agree(patch: Patch) -> None:
    theta = parameters(patch, 5)
    pairs = np.stack(np.meshgrid(*theta.T, indexing="ij"), axis=-1).reshape(-1, 2)
    for orders in ORDERS:
        grid = patch.evaluate(theta[:, 0], theta[:, 1], orders)
        points = patch.evaluate_points(pairs, orders)
        functions = patch.functions(pairs, orders)
        scale = np.abs(functions).sum(axis=1).max() * np.abs(patch.control_points).max()
        # the same quotient from sums in another order
        np.testing.assert_allclose(grid, points, rtol=0, atol=1e-13 * scale)
        net = patch.control_points.reshape(-1, 3)
        np.testing.assert_allclose(functions @ net, points, rtol=0, atol=1e-13 * scale)


@settings(deadline=None)
@given(rational_patches())
def test_the_functions_are_a_partition_of_unity(patch: Patch) -> None:
    theta = parameters(patch)
    for orders in ORDERS:
        functions = patch.functions(theta, orders)
        expected = 1.0 if orders == (0, 0) else 0.0
        # cancellation of derivatives as large as the functions' own
        scale = np.abs(functions).sum(axis=1).max()
        assert np.abs(functions.sum(axis=1) - expected).max() < 1e-13 * scale


@settings(deadline=None)
@given(bumpy_patches(), st.sampled_from([0.25, 1.0, 0.3]))
def test_equal_weights_change_nothing(patch: Patch, weight: float) -> None:
    weights = np.full(patch.control_points.shape[:2], weight)
    rational = Patch(patch.first, patch.second, patch.control_points, weights)
    theta = parameters(patch)
    for orders in ORDERS:
        plain = patch.functions(theta, orders)
        # W = weight up to round-off; its derivatives vanish up to round-off of theirs
        scale = np.abs(plain).sum(axis=1).max()
        np.testing.assert_allclose(
            rational.functions(theta, orders), plain, rtol=0, atol=1e-14 * scale
        )


@settings(deadline=None)
@given(rational_patches(max_degree=2), st.integers(0, 2), st.integers(1, 3))
def test_refinement_moves_no_point(patch: Patch, raised: int, split: int) -> None:
    degree = max(patch.first.degree, patch.second.degree) + raised
    finer = patch.refine(degree, (patch.first.elements * split, patch.second.elements * split))
    theta = parameters(patch, 30)
    # round-off of coordinates up to 12 after two interpolations of condition below 1e2
    np.testing.assert_allclose(
        finer.evaluate_points(theta), patch.evaluate_points(theta), rtol=0, atol=1e-12
    )


@settings(deadline=None)
@given(rational_patches())
def test_interpolation_gives_the_control_net_back(patch: Patch) -> None:
    points = patch.evaluate(patch.first.greville(), patch.second.greville())
    again = patch.interpolate(points)
    # as for polynomial patches; the weights add a factor of four
    np.testing.assert_allclose(again.control_points, patch.control_points, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(again.weights, patch.weights)


@pytest.mark.parametrize(
    ("patch", "larger"),
    [
        (cylindrical_panel(2.0, 3.0, (-40, 80)), cylindrical_panel(2.3, 3.0, (-40, 80))),
        (spherical_panel(2.0, (0, 90), (0, 70)), spherical_panel(2.3, (0, 90), (0, 70))),
    ],
    ids=["cylinder", "sphere"],
)
def test_the_offset_of_a_cylinder_and_of_a_sphere_is_exact(patch: Patch, larger: Patch) -> None:
    theta = parameters(patch, 50)
    moved = offset(patch.refine(3, (4, 5)), 0.3)
    # a scaled surface lies in the same rational space: round-off of one interpolation
    np.testing.assert_allclose(
        moved.evaluate_points(theta), larger.evaluate_points(theta), rtol=0, atol=1e-14
    )


@pytest.mark.parametrize("weights", [None, np.array([[1.0, 0.5], [2.0, 1.0]])])
def test_a_patch_is_stored_with_or_without_weights(
    weights: np.ndarray | None, tmp_path: Path
) -> None:
    flat = Patch.rectangle(3.5, 2.0)
    patch = Patch(flat.first, flat.second, flat.control_points, weights)
    codecs.save(tmp_path, MidSurface(patch))
    kept = codecs.load(tmp_path, MidSurface).patch
    np.testing.assert_array_equal(kept.control_points, patch.control_points)
    if weights is None:
        assert kept.weights is None
    else:
        np.testing.assert_array_equal(kept.weights, weights)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_a_weight_that_is_not_positive_is_refused(bad: float) -> None:
    flat = Patch.rectangle(1.0, 1.0)
    with pytest.raises(ValueError, match=r"weight of control point \(1, 0\) is"):
        Patch(flat.first, flat.second, flat.control_points, np.array([[1.0, 1.0], [bad, 1.0]]))


def test_weights_of_the_wrong_shape_are_refused() -> None:
    flat = Patch.rectangle(1.0, 1.0)
    with pytest.raises(ValueError, match=r"weights of shape \(3,\) do not fit a net of 2 x 2"):
        Patch(flat.first, flat.second, flat.control_points, np.ones(3))
