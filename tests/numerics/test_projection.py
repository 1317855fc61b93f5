"""Projection of Gauss-point values: exact on splines, best in the mean otherwise."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.patches import Patch
from stages.numerics.projection import GaussProjection
from stages.numerics.quadrature import quadrature_grid

FILM = Patch.rectangle(3.5, 2.0).refine(2, (7, 3))
GRID = quadrature_grid(FILM, 3)
AT = np.linspace(0.0, 1.0, 5), np.array([0.0, 0.3, 1.0])
PROJECTION = GaussProjection.onto(FILM, 7 * 3 * 9, *AT)


def test_a_spline_is_reproduced() -> None:
    def field(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        return first[:, None] ** 2 * (1.0 - second) + 3.0 * second**2

    projected = PROJECTION.on_grid(field(GRID.theta1, GRID.theta2).ravel())
    # a well-conditioned mass matrix of 9 functions: round-off only
    np.testing.assert_allclose(projected, field(*AT), atol=1e-13)


def test_the_mean_of_a_rough_field_is_kept() -> None:
    values = np.random.default_rng(1).uniform(size=(GRID.theta1.size, GRID.theta2.size))
    fine = GaussProjection.onto(FILM, values.size, GRID.theta1, GRID.theta2)
    weights = np.outer(GRID.weights1, GRID.weights2)
    mean = (weights * fine.on_grid(values.ravel())).sum()
    # constants are splines, so the error has no mean; round-off only
    assert mean == pytest.approx((weights * values).sum(), rel=1e-13)


def test_single_points_are_those_of_the_grid() -> None:
    values = np.random.default_rng(2).uniform(size=7 * 3 * 9)
    pairs = GaussProjection.onto(FILM, values.size, AT[0][:3], AT[1])
    at_points = pairs.at_points() @ values
    np.testing.assert_allclose(at_points, np.diagonal(pairs.on_grid(values)), rtol=1e-13)


def test_a_field_of_another_mesh_is_refused() -> None:
    with pytest.raises(ValueError, match="7 x 3 elements"):
        GaussProjection.onto(FILM, 100, *AT)
