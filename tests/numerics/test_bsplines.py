"""Spline spaces reproduce polynomials, keep their functions under refinement, refuse nonsense."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.numerics.bsplines import SplineSpace
from tests.strategies import spline_spaces

ROUND_OFF = 1e-13  # a few dozen operations of order one, each rounded by 1e-16


@given(spline_spaces(), st.integers(0, 2**32 - 1))
def test_basis_functions_are_positive_and_sum_to_one(space: SplineSpace, seed: int) -> None:
    x = np.random.default_rng(seed).uniform(space.knots[0], space.knots[-1], 40)
    values = space.evaluate(x)
    assert values.min() >= -ROUND_OFF
    np.testing.assert_allclose(values.sum(axis=1), 1.0, rtol=0, atol=ROUND_OFF)


@given(spline_spaces())
def test_greville_points_reproduce_the_identity(space: SplineSpace) -> None:
    """sum_i N_i(x) xi_i = x: the defining property of eq. 70."""
    x = np.linspace(space.knots[0], space.knots[-1], 33)
    # x is up to 12, so its round-off is 12 times that of the functions
    np.testing.assert_allclose(space.evaluate(x) @ space.greville(), x, rtol=0, atol=12 * ROUND_OFF)


@given(spline_spaces())
def test_interpolation_reproduces_polynomials_and_their_derivatives(space: SplineSpace) -> None:
    scale = space.knots[-1]
    x = np.linspace(0.0, scale, 29)[1:-1]
    polynomial = np.polynomial.Polynomial(np.arange(1.0, space.degree + 2.0), [0, scale], [0, 1])
    control = space.interpolate(polynomial(space.greville()))
    for order in range(space.degree + 1):
        exact = polynomial.deriv(order)(x) if order else polynomial(x)
        found = space.evaluate(x, order) @ control
        # values up to 15; a derivative of degree p multiplies round-off by 2 p over a span >= 0.2
        np.testing.assert_allclose(found, exact, rtol=0, atol=15 * ROUND_OFF * 40.0**order)


@given(spline_spaces())
def test_cardinal_splines_are_one_at_their_own_greville_point(space: SplineSpace) -> None:
    # round-off times the condition of interpolation, below 1e2 for degree 4 on uneven spans
    at_points = space.cardinals(space.greville())
    np.testing.assert_allclose(at_points, np.eye(space.size), rtol=0, atol=1e-13)


@given(spline_spaces())
def test_only_the_local_functions_differ_from_zero(space: SplineSpace) -> None:
    x = np.linspace(space.knots[0], space.knots[-1], 17)
    first, values = space.local(x, derivatives=1)
    dense = np.zeros((2, x.size, space.size))
    for point in range(x.size):
        window = slice(first[point], first[point] + space.degree + 1)
        dense[:, point, window] = values[:, point]
    for order in (0, 1):
        np.testing.assert_array_equal(dense[order], space.evaluate(x, order))  # the same numbers


@given(spline_spaces(max_degree=3), st.integers(0, 2), st.integers(1, 4))
def test_refinement_changes_no_value(space: SplineSpace, raised: int, split: int) -> None:
    finer = space.refine(space.degree + raised, space.elements * split)
    control = np.cos(np.arange(space.size) * 1.7)
    x = np.linspace(space.knots[0], space.knots[-1], 41)
    before = space.evaluate(x) @ control
    after = finer.evaluate(x) @ (space.embed(finer) @ control)
    # values of order one through one interpolation
    np.testing.assert_allclose(after, before, rtol=0, atol=ROUND_OFF)
    assert finer.elements == space.elements * split


def test_the_papers_mesh_has_104_functions_of_102_spans() -> None:
    space = SplineSpace.uniform(1, 1).refine(degree=2, elements=102)
    assert (space.size, space.elements, space.continuity) == (104, 102, 1)


@pytest.mark.parametrize(
    ("degree", "knots", "message"),
    [
        (0, [0, 1], "degree 0"),
        (2, [0, 0, 1, 1], "at least 6 knots"),
        (1, [0, 0, 2, 1, 3, 3], "decrease"),
        (2, [0, 0, 1, 2, 2, 2], "not open"),
        (1, [0, 0, 1, 1, 2, 2], "repeated too often"),
    ],
)
def test_a_bad_knot_vector_is_refused(degree: int, knots: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        SplineSpace(degree, np.array(knots, dtype=float))


def test_a_parameter_outside_the_domain_is_refused() -> None:
    with pytest.raises(ValueError, match=r"1\.5 lies outside"):
        SplineSpace.uniform(2, 3).evaluate(np.array([0.2, 1.5]))


def test_refinement_that_would_lose_geometry_is_refused() -> None:
    space = SplineSpace.uniform(3, 2)
    with pytest.raises(ValueError, match="below"):
        space.refine(degree=2, elements=4)
    with pytest.raises(ValueError, match="evenly"):
        space.refine(degree=3, elements=5)
