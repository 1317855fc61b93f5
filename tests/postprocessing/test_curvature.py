"""Curvature from the projected length (eq. 101), on arcs of known radius."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.bsplines import SplineSpace
from stages.numerics.patches import Patch
from stages.postprocessing.axis import follow_axis
from stages.postprocessing.curvature import (
    arc_length,
    curvature_from_projection,
    widest_point,
)

LENGTH = 3.5


def rolled(film: Patch, curvature: float) -> np.ndarray:
    """Displacement of the control points that rolls the film up to a circular cylinder."""
    points = film.evaluate(*(space.greville() for space in film.spaces))
    x = points[:, 0]
    arc = np.stack(
        (np.sin(curvature * x) / curvature, points[:, 1], (1 - np.cos(curvature * x)) / curvature),
        axis=-1,
    )
    return (film.interpolate(arc).control_points - film.control_points).reshape(-1, 3)


def projection_of_arc(curvature: float) -> float:
    """Widest point of an arc of length L: its end, or the circle's own widest point."""
    angle = curvature * LENGTH
    return (np.sin(angle) if angle < np.pi / 2 else 1.0) / curvature


@pytest.mark.parametrize("degrees", [0.01, 1, 30, 89.9, 90, 90.1, 120, 179, 181, 270, 400])
def test_an_arc_of_any_angle_gives_its_curvature_back(degrees: float) -> None:
    curvature = np.deg2rad(degrees) / LENGTH
    found = curvature_from_projection(projection_of_arc(curvature), LENGTH)
    # Near flat, 1 - x/L = (kL)^2/6 is resolved to 2e-16: the relative error of k is 3 * 2e-16/(kL)^2,
    # 2e-8 at 0.01 degrees.
    assert found == pytest.approx(curvature, rel=1e-12 + 1e-15 / (curvature * LENGTH) ** 2)


def test_the_two_branches_meet_at_ninety_degrees() -> None:
    edge = 2 * LENGTH / np.pi
    below, above = (curvature_from_projection(edge * (1 + s), LENGTH) for s in (-1e-9, 1e-9))
    # One side changes as -x, the other as the arc's sine: both by less than 1e-9 of pi/(2L) = 0.449.
    assert abs(below - above) < 1e-8


def test_the_printed_threshold_would_understate_a_film_curled_past_vertical() -> None:
    # 0.78 /mm belongs to 156 degrees, where the printed threshold still takes the sine branch.
    assert curvature_from_projection(1 / 0.78, LENGTH) == pytest.approx(0.78, rel=1e-15)
    assert LENGTH / np.pi < 1 / 0.78 < 2 * LENGTH / np.pi


def test_a_flat_or_stretched_film_has_no_curvature() -> None:
    assert curvature_from_projection(LENGTH, LENGTH) == 0.0
    assert curvature_from_projection(LENGTH * 1.01, LENGTH) == 0.0


def test_an_almost_flat_film_has_a_small_curvature() -> None:
    found = curvature_from_projection(np.nextafter(LENGTH, 0.0), LENGTH)
    assert 0.0 <= found < 1e-7  # sqrt(6 * 1.3e-16) / 3.5 = 8e-9


def test_a_film_without_projection_is_refused() -> None:
    with pytest.raises(ValueError, match="folds back behind its clamped edge"):
        curvature_from_projection(-0.1, LENGTH)


@pytest.mark.parametrize("degrees", [20, 80, 110, 200, 300])
def test_the_curvature_of_a_rolled_film_is_measured_on_its_spline(degrees: float) -> None:
    film = Patch.rectangle(LENGTH, 2.0).refine(2, (50, 10))
    curvature = np.deg2rad(degrees) / LENGTH
    axis = follow_axis(film, rolled(film, curvature)[None], theta2=0.5)
    # Quadratic interpolation errs by about (h k)^3/15 of the radius with h k = 0.1 at 300 degrees:
    # 7e-5; 1 - x/L = (kL)^2/6 = 0.02 at 20 degrees magnifies its error of 1e-8 by 25.
    assert axis.curvature[0] == pytest.approx(curvature, rel=1e-4)
    # The tangents at the ends err by about (h k)^2/6, and h k = 0.1 at 300 degrees.
    assert axis.turning[0] == pytest.approx(degrees, abs=np.rad2deg(4e-3))


def test_the_curvature_follows_a_rolling_film_without_jumps() -> None:
    film = Patch.rectangle(LENGTH, 2.0).refine(2, (50, 10))
    curvatures = np.linspace(0.6, 0.7, 41)  # the widest point moves over several elements
    frames = np.stack([rolled(film, k) for k in curvatures])
    found = follow_axis(film, frames, theta2=0.5).curvature
    # Smooth to second differences: sampling at 4 points per element would leave kinks of 2e-4.
    assert np.abs(np.diff(found, 2)).max() < 2e-6


def test_the_widest_point_may_lie_at_either_end() -> None:
    space = SplineSpace.uniform(2, 5)
    assert widest_point(space, space.greville()) == 1.0
    assert widest_point(space, -space.greville()) == 0.0


def test_the_widest_point_inside_is_exact_between_samples() -> None:
    space = SplineSpace.uniform(3, 7)
    top = 0.537
    coefficients = space.interpolate(1.0 - (space.greville() - top) ** 2)
    # A parabola lies in the space; its maximum is found to rounding although no sample is on it.
    assert widest_point(space, coefficients) == pytest.approx(1.0, abs=1e-14)


def test_the_length_of_a_quarter_circle_is_recovered() -> None:
    film = Patch.rectangle(np.pi / 2, 1.0).refine(3, (40, 1))
    bent = film.control_points + rolled(film, 1.0).reshape(film.control_points.shape)
    # Cubic splines with h = 0.04: interpolation error of order h^4 = 2e-6.
    assert arc_length(film.first, bent[:, 0]) == pytest.approx(np.pi / 2, rel=2e-6)
