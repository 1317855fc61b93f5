"""Quadrature through the layers: depths, reference metric and fibres on curved films."""

from __future__ import annotations

import numpy as np
import pytest

from stages.mechanics.shell.discretisation import basis_on_grid
from stages.mechanics.shell.kinematics import Frames, compute_frames
from stages.mechanics.shell.laminate import LayerPoints, points_through, surface_density
from stages.mechanics.shell.shell import build_shell
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.surface_geometry import SurfaceFrame, frame_on_grid
from tests.mechanics import films

ARCHED = films.arched((3, 2))


@pytest.fixture(scope="module")
def frames() -> Frames:
    basis, weights = basis_on_grid(ARCHED, 3)
    found = Frames.empty(weights.size)
    compute_frames(basis, ARCHED.control_points.reshape(-1, 3), found)
    return found


@pytest.fixture(scope="module")
def surface() -> SurfaceFrame:
    grid = quadrature_grid(ARCHED, 3)
    return frame_on_grid(ARCHED, grid.theta1, grid.theta2)


def layers(frames: Frames, angle: float = 30.0) -> tuple[LayerPoints, ...]:
    return points_through(films.two_layers(angle), films.MATERIALS, frames, 3)


def test_frames_equal_those_of_the_surface_geometry(frames: Frames, surface: SurfaceFrame) -> None:
    pairs = ((0, 0), (1, 1), (0, 1))
    # the same formulas in another order of operations
    np.testing.assert_allclose(frames.tangents, surface.tangents, atol=1e-12)
    np.testing.assert_allclose(frames.dual, surface.dual, atol=1e-12)
    np.testing.assert_allclose(frames.normal, surface.normal, atol=1e-14)
    np.testing.assert_allclose(frames.area, surface.area, rtol=1e-13)
    for k, (a, b) in enumerate(pairs):
        np.testing.assert_allclose(frames.metric[:, k], surface.metric_cov[:, a, b], atol=1e-12)
        np.testing.assert_allclose(frames.curvature[:, k], surface.curvature[:, a, b], atol=1e-12)
        np.testing.assert_allclose(
            frames.christoffel[:, :, k], surface.christoffel[:, :, a, b], atol=1e-12
        )


def test_layers_lie_on_one_another_and_fill_the_thickness(frames: Frames) -> None:
    bottom, top = layers(frames)
    np.testing.assert_allclose(bottom.depth.mean(), -0.011 + 0.009, atol=1e-16)
    np.testing.assert_allclose(top.depth.mean(), 0.011 - 0.002, atol=1e-16)
    assert bottom.weights.sum() == pytest.approx(0.018, rel=1e-14)
    assert top.weights.sum() == pytest.approx(0.004, rel=1e-14)
    assert surface_density((bottom, top)) == pytest.approx(0.965 * 0.022, rel=1e-14)


def test_the_metric_at_depth_is_that_of_the_parallel_surface(
    frames: Frames, surface: SurfaceFrame
) -> None:
    """g_ab = (a_a + z a_3,a) . (a_b + z a_3,b), with a_3,a by finite differences of the normal."""
    h = 1e-6
    grid = quadrature_grid(ARCHED, 3)

    def normals(d1: float, d2: float) -> np.ndarray:
        return frame_on_grid(ARCHED, grid.theta1 + d1, grid.theta2 + d2).normal

    slopes = np.stack(
        ((normals(h, 0) - normals(-h, 0)) / (2 * h), (normals(0, h) - normals(0, -h)) / (2 * h)), 1
    )
    for points in layers(frames):
        for k, z in enumerate(points.depth):
            g = surface.tangents + z * slopes
            con = np.linalg.inv(np.einsum("pax,pbx->pab", g, g))
            reference = points.reference[:, k]
            # differences of unit normals over 2e-6: about 1e-9
            np.testing.assert_allclose(reference[:, 0], con[:, 0, 0], rtol=1e-8)
            np.testing.assert_allclose(reference[:, 1], con[:, 1, 1], rtol=1e-8)
            np.testing.assert_allclose(reference[:, 2], con[:, 0, 1], rtol=1e-8, atol=1e-9)
            np.testing.assert_allclose(reference[:, 3], np.linalg.det(con), rtol=1e-8)


def test_fibres_are_unit_vectors_at_every_depth(frames: Frames) -> None:
    """f0^a G_ab f0^b = 1: the stretch of an undeformed film is one."""
    for points in layers(frames):
        con11, con22, con12, inverse, ff11, ff22, ff12 = np.moveaxis(points.reference, -1, 0)
        cov11, cov22, cov12 = con22 / inverse, con11 / inverse, -con12 / inverse
        # round-off of a few products
        np.testing.assert_allclose(cov11 * ff11 + cov22 * ff22 + 2 * cov12 * ff12, 1, rtol=1e-13)


def test_the_fibre_angle_is_measured_from_x_on_a_flat_film() -> None:
    body = films.shell(films.flat((2, 2)), films.two_layers(angle=30.0))
    ff11, ff22, ff12 = body.layers[1].reference[0, 0, 4:]
    # f0 = (cos 30, sin 30) in mm; theta runs from 0 to 1 over 3.5 and 2 mm
    assert ff11 * 3.5**2 == pytest.approx(0.75, rel=1e-12)
    assert ff22 * 2.0**2 == pytest.approx(0.25, rel=1e-12)
    assert ff12 * 7.0 == pytest.approx(np.sqrt(0.1875), rel=1e-12)


def test_a_thin_shell_keeps_the_metric_of_its_mid_surface(frames: Frames) -> None:
    laminate = films.two_layers(30.0)
    for points in points_through(laminate, films.MATERIALS, frames, 3, thin=True):
        for k in range(points.depth.size):
            np.testing.assert_array_equal(points.reference[:, k], points.reference[:, 0])
        assert points.reference[0, 0, 3] == pytest.approx(1 / frames.area[0] ** 2, rel=1e-13)


def test_thin_or_not_is_the_same_on_a_flat_film() -> None:
    flat = films.flat((2, 2))
    exact, thin = (
        build_shell(flat, films.two_layers(), films.MATERIALS, thin=thin) for thin in (False, True)
    )
    for a, b in zip(exact.layers, thin.layers, strict=True):
        np.testing.assert_array_equal(a.reference, b.reference)
