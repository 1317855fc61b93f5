"""Frames agree with closed forms and with finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import frame_at, offset
from tests.problems import parabolic_sheet
from tests.strategies import bumpy_patches


def test_a_parabolic_sheet_has_its_closed_form_metric_and_curvature() -> None:
    """r = (x, y, b x^2/2) with x = L t1: a_11 = L^2 (1 + s^2), b_11 = L^2 b / sqrt(1 + s^2), s = b x."""
    bend, length, width = 0.8, 3.5, 2.0
    theta = np.random.default_rng(1).uniform(0, 1, (30, 2))
    frame = frame_at(parabolic_sheet(bend, length, width), theta)
    slope = bend * length * theta[:, 0]
    root = np.sqrt(1 + slope**2)
    # closed forms of a few operations: round-off
    np.testing.assert_allclose(frame.metric_cov[:, 0, 0], (length * root) ** 2, rtol=1e-13)
    np.testing.assert_allclose(frame.metric_cov[:, 1, 1], width**2, rtol=1e-13)
    np.testing.assert_allclose(frame.curvature[:, 0, 0], length**2 * bend / root, rtol=1e-13)
    np.testing.assert_allclose(frame.area, length * root * width, rtol=1e-13)
    gamma = frame.christoffel  # Gamma^1_11 = a_11,1 / (2 a_11) in one curved direction
    np.testing.assert_allclose(
        gamma[:, 0, 0, 0], length * bend * slope / (1 + slope**2), rtol=1e-12, atol=1e-15
    )
    assert np.abs(gamma[:, 1]).max() < 1e-14  # zero, but for round-off of terms of order one


@settings(deadline=None)
@given(bumpy_patches())
def test_dual_vectors_and_weingarten_hold_on_any_surface(patch: Patch) -> None:
    theta = np.random.default_rng(3).uniform(0.05, 0.95, (12, 2))
    theta *= [patch.first.knots[-1], patch.second.knots[-1]]
    frame = frame_at(patch, theta)
    identity = np.einsum("pax,pbx->pab", frame.dual, frame.tangents)
    # the inverse of a metric whose condition is below 1e2
    expected = np.broadcast_to(np.eye(2), identity.shape)
    np.testing.assert_allclose(identity, expected, rtol=0, atol=1e-13)
    step = 1e-6
    for direction in (0, 1):
        ahead, behind = theta.copy(), theta.copy()
        ahead[:, direction] += step
        behind[:, direction] -= step
        slope = (frame_at(patch, ahead).normal - frame_at(patch, behind).normal) / (2 * step)
        # central differences: step^2 = 1e-12 times third derivatives of up to 1e2, and round-off
        # 1e-16 / step = 1e-10 of a few operations; points whose stencil straddles a knot see a jump
        # of the curvature and are left out
        whole = _same_span(patch, ahead, behind)
        np.testing.assert_allclose(
            frame.normal_derivatives[whole, direction], slope[whole], rtol=0, atol=1e-8
        )


def _same_span(patch: Patch, ahead: np.ndarray, behind: np.ndarray) -> np.ndarray:
    return np.all(
        [s.span(ahead[:, k]) == s.span(behind[:, k]) for k, s in enumerate(patch.spaces)], axis=0
    )


def test_the_offset_of_a_flat_film_is_a_translation() -> None:
    film = Patch.rectangle(3.5, 2.0).refine(2, (10, 6))
    moved = offset(film, 0.009)
    expected = film.control_points + np.array([0.0, 0.0, 0.009])
    # coordinates up to 3.5, interpolated once
    np.testing.assert_allclose(moved.control_points, expected, rtol=0, atol=1e-14)


def test_the_offset_of_a_curved_film_converges_to_the_parallel_surface() -> None:
    """Distance from the sheet along its normal, at points between the Greville points."""
    sheet, distance = parabolic_sheet(0.8, 3.5, 2.0), 0.3
    theta = np.random.default_rng(5).uniform(0, 1, (200, 2))
    frame = frame_at(sheet, theta)
    exact = frame.position + distance * frame.normal
    errors = []
    for elements in (4, 8, 16):
        moved = offset(sheet.refine(2, (elements, 1)), distance)
        errors.append(np.abs(moved.evaluate_points(theta) - exact).max())
    # quadratic interpolation: third order, a factor of 8; above 5 on meshes this coarse
    assert errors[2] < errors[1] / 5 < errors[0] / 25


def test_a_degenerate_surface_is_refused() -> None:
    flat = Patch.rectangle(1.0, 1.0)
    net = flat.control_points.copy()
    net[..., 1] = 0.0
    with pytest.raises(ValueError, match="degenerates"):
        frame_at(Patch(flat.first, flat.second, net), np.array([[0.5, 0.5]]))
