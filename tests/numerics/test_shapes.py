"""Cylinders and spheres are exact: points, frames, areas, and the way back from point to parameter."""

from __future__ import annotations

import numpy as np
import pytest

from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.shapes import bilinear_quad, cylindrical_panel, spherical_panel
from stages.numerics.surface_geometry import frame_at, frame_on_grid, locate

RADIUS = 2.5
THETA = np.random.default_rng(4).uniform(0, 1, (60, 2))
ARCS = [(-40.0, 40.0), (0.0, 90.0), (10.0, 165.0)]


@pytest.mark.parametrize("angles", ARCS)
@pytest.mark.parametrize("refined", [False, True])
def test_a_cylindrical_panel_lies_on_its_cylinder(
    angles: tuple[float, float], refined: bool
) -> None:
    panel = cylindrical_panel(RADIUS, 4.0, angles)
    panel = panel.refine(4, (3, 5)) if refined else panel
    x, y, z = panel.evaluate_points(THETA).T
    # a relative error of 1e-14: the sums and the quotient round a few times
    np.testing.assert_allclose(np.hypot(y, z), RADIUS, rtol=1e-14)
    np.testing.assert_allclose(x, 4.0 * THETA[:, 0], rtol=0, atol=1e-14)
    phi = np.rad2deg(np.arctan2(y, z))
    assert phi.min() > angles[0]
    assert phi.max() < angles[1]
    ends = panel.evaluate([0.0], [0.0, 1.0])
    for point, angle in zip(ends, np.deg2rad(angles), strict=True):
        expected = [0.0, RADIUS * np.sin(angle), RADIUS * np.cos(angle)]
        np.testing.assert_allclose(point, expected, rtol=0, atol=1e-14)


@pytest.mark.parametrize("angles", ARCS)
def test_the_frame_of_a_cylinder_has_its_closed_form(angles: tuple[float, float]) -> None:
    frame = frame_at(cylindrical_panel(RADIUS, 4.0, angles).refine(3, (2, 4)), THETA)
    outward = frame.position * [0.0, 1.0, 1.0] / RADIUS
    # second derivatives over spans of 1/4 carry about 1e2 units of round-off
    np.testing.assert_allclose(frame.normal, outward, rtol=0, atol=1e-13)
    mixed = np.einsum("pac,pcb->pab", frame.metric_con, frame.curvature)
    np.testing.assert_allclose(mixed[:, 1, 1], -1.0 / RADIUS, rtol=1e-12)
    assert np.abs(mixed[:, 0]).max() < 1e-12


@pytest.mark.parametrize("refined", [False, True])
def test_a_spherical_panel_lies_on_its_sphere(refined: bool) -> None:
    panel = spherical_panel(RADIUS, (-30.0, 60.0), (-20.0, 72.0))
    panel = panel.refine(3, (4, 3)) if refined else panel
    frame = frame_at(panel, THETA)
    # as on the cylinder
    np.testing.assert_allclose(np.linalg.norm(frame.position, axis=1), RADIUS, rtol=1e-14)
    np.testing.assert_allclose(frame.normal, frame.position / RADIUS, rtol=0, atol=1e-13)
    mixed = np.einsum("pac,pcb->pab", frame.metric_con, frame.curvature)
    expected = np.broadcast_to(-np.eye(2) / RADIUS, mixed.shape)
    np.testing.assert_allclose(mixed, expected, rtol=0, atol=1e-12)


def area(patch: Patch, points: int) -> float:
    grid = quadrature_grid(patch, points)
    frame = frame_on_grid(patch, grid.theta1, grid.theta2)
    return float((grid.weights1[:, None] * grid.weights2).ravel() @ frame.area)


def test_the_area_of_the_hemisphere_is_two_pi_square_of_the_radius() -> None:
    octant = spherical_panel(RADIUS, (0.0, 90.0), (0.0, 90.0))
    # smooth integrand: 12 Gauss points in each of 4 x 4 elements leave round-off
    assert 4 * area(octant.refine(2, (4, 4)), 12) == pytest.approx(2 * np.pi * RADIUS**2, rel=1e-13)


def test_the_area_of_a_cylindrical_panel_is_arc_times_length() -> None:
    panel = cylindrical_panel(RADIUS, 4.0, (-40.0, 40.0))
    assert area(panel.refine(2, (1, 4)), 12) == pytest.approx(
        RADIUS * np.deg2rad(80.0) * 4.0, rel=1e-13
    )


@pytest.mark.parametrize(
    "patch",
    [
        cylindrical_panel(RADIUS, 4.0, (-40.0, 80.0)),
        spherical_panel(RADIUS, (0.0, 90.0), (0.0, 72.0)),
        bilinear_quad([[[0, 0, 0], [0, 1, 0]], [[2, 0, 0], [4, 1, 1]]]),
    ],
    ids=["cylinder", "sphere", "quad"],
)
def test_a_point_of_the_shape_is_located(patch: Patch) -> None:
    found = locate(patch, patch.evaluate_points(THETA))
    # Gauss-Newton stops at round-off of positions of size 4
    np.testing.assert_allclose(found, THETA, rtol=0, atol=1e-13)


@pytest.mark.parametrize("angles", [(0.0, 180.0), (40.0, 40.0), (80.0, 10.0)])
def test_an_arc_that_is_no_single_segment_is_refused(angles: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="less than 180"):
        cylindrical_panel(RADIUS, 1.0, angles)


def test_latitudes_past_the_pole_are_refused() -> None:
    with pytest.raises(ValueError, match="pass a pole"):
        spherical_panel(RADIUS, (0.0, 90.0), (0.0, 100.0))


def test_a_panel_without_size_is_refused() -> None:
    with pytest.raises(ValueError, match="the length 0 is not positive"):
        cylindrical_panel(RADIUS, 0.0, (0.0, 90.0))
