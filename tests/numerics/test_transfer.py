"""Fields go from collocation points to a grid as the spline says, or within their neighbours' range."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stages.numerics.patches import Patch
from stages.numerics.quadrature import QuadratureGrid, quadrature_grid
from stages.numerics.transfer import TransferKind, surface_transfer

FILM = Patch.rectangle(3.5, 2.0)
SHELL = FILM.refine(2, (8, 4))
GRID: QuadratureGrid = quadrature_grid(SHELL, 3)
KINDS: tuple[TransferKind, ...] = ("spline", "shape-preserving")


def points_of(patch: Patch) -> np.ndarray:
    return patch.evaluate(patch.first.greville(), patch.second.greville())


def transferred(kind: TransferKind, surface: Patch, values: np.ndarray) -> np.ndarray:
    return surface_transfer(kind, surface, GRID.theta1, GRID.theta2)(values)


def neighbours(surface: Patch, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest of the four collocated values around each grid point."""
    left = [
        np.clip(np.searchsorted(s.greville(), at, side="right") - 1, 0, s.size - 2)
        for s, at in zip(surface.spaces, (GRID.theta1, GRID.theta2), strict=True)
    ]
    table = values.reshape(surface.first.size, surface.second.size)
    corners = [table[np.ix_(left[0] + i, left[1] + j)].ravel() for i in (0, 1) for j in (0, 1)]
    return np.min(corners, axis=0), np.max(corners, axis=0)


def test_a_quadratic_field_goes_over_exactly_by_the_spline() -> None:
    """Quadratic splines hold it, so collocation and evaluation change nothing but round-off."""

    def field(points: np.ndarray) -> np.ndarray:
        x, y = points[:, 0], points[:, 1]
        return 1.0 + 2.0 * x - 3.0 * y + 0.5 * x * y + x**2 - 0.25 * (x * y) ** 2

    surface = FILM.refine(2, (20, 12))
    exact = field(SHELL.evaluate(GRID.theta1, GRID.theta2))
    # round-off of values up to 50, through interpolation matrices of condition below 10
    got = transferred("spline", surface, field(points_of(surface)))
    np.testing.assert_allclose(got, exact, rtol=0, atol=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("degree", [2, 3, 4, 6])
def test_a_bilinear_field_goes_over_exactly(kind: TransferKind, degree: int) -> None:
    surface = FILM.refine(degree, (9, 5))
    x, y = points_of(surface)[:, :2].T
    at = SHELL.evaluate(GRID.theta1, GRID.theta2)
    exact = 1.0 + 2.0 * at[:, 0] - 3.0 * at[:, 1] + at[:, 0] * at[:, 1]
    got = transferred(kind, surface, 1.0 + 2.0 * x - 3.0 * y + x * y)
    # round-off of values up to 8, through interpolation matrices of condition below 100
    np.testing.assert_allclose(got, exact, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("kind", "degree", "order"),
    [
        ("spline", 2, 2.8),  # third order, from above 2.8 on meshes of two elements per radian
        ("spline", 4, 4.7),  # fifth order
        ("shape-preserving", 2, 1.8),  # second order, at the extrema
        ("shape-preserving", 4, 1.8),
    ],
)
def test_a_smooth_field_converges(kind: TransferKind, degree: int, order: float) -> None:
    errors = []
    for elements in ((10, 6), (20, 12), (40, 24)):
        surface = FILM.refine(degree, elements)
        x, y = points_of(surface)[:, :2].T
        at = SHELL.evaluate(GRID.theta1, GRID.theta2)
        exact = np.sin(2.0 * at[:, 0]) * np.cos(1.5 * at[:, 1])
        got = transferred(kind, surface, np.sin(2.0 * x) * np.cos(1.5 * y))
        errors.append(np.abs(got - exact).max())
    assert np.log2(errors[1] / errors[2]) > order


@given(degree=st.integers(2, 6), seed=st.integers(0, 2**32 - 1), exponent=st.integers(-8, 8))
def test_a_shape_preserving_transfer_stays_between_its_neighbours(
    degree: int, seed: int, exponent: int
) -> None:
    surface = FILM.refine(degree, (9, 5))
    random = np.random.default_rng(seed)
    values = random.choice([0.0, 1.0], surface.size) * random.normal(size=surface.size)
    values *= 10.0**exponent
    low, high = neighbours(surface, values)
    got = transferred("shape-preserving", surface, values)
    slack = 1e-14 * np.abs(values).max()  # round-off of a cubic's four terms
    assert (got >= low - slack).all()
    assert (got <= high + slack).all()


def test_a_switching_front_makes_the_spline_swing_and_the_other_not() -> None:
    """From 0 to 12 kPa between two points: quartic splines swing by kilopascals, and below zero."""
    surface = FILM.refine(4, (20, 12))
    front = np.where(points_of(surface)[:, 0] < 1.3, 12.0, 0.0)
    spline = transferred("spline", surface, front)
    assert spline.min() < -0.5
    assert spline.max() > 12.5
    monotone = transferred("shape-preserving", surface, front)
    assert monotone.min() >= 0.0
    assert monotone.max() <= 12.0
