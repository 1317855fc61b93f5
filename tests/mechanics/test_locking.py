"""Meshes too coarse for how much a film bends are told; fine and cubic ones are not."""

from __future__ import annotations

import numpy as np
import pytest

from stages.mechanics.shell.locking import LARGEST, locked, sag
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.mechanics import films


def bent(patch: Patch, curvature: float) -> Array:
    """Displacement that rolls the film along X onto a cylinder, interpolated."""
    theta = [space.greville() for space in patch.spaces]
    x, y, _ = patch.evaluate(*theta).T
    arc = np.stack(
        (np.sin(curvature * x) / curvature, y, (1.0 - np.cos(curvature * x)) / curvature), axis=-1
    )
    return (patch.interpolate(arc).control_points - patch.control_points).reshape(-1, 3)


@pytest.mark.parametrize("patch", [films.flat((20, 4)), films.flat((20, 4), degree=3)])
def test_the_sag_of_an_arc_is_h2_k_over_d(patch: Patch) -> None:
    along, across = sag(films.shell(patch), bent(patch, 0.5))
    # splines follow the arc to h^2 k^2 of its curvature
    assert along == pytest.approx((3.5 / 20) ** 2 * 0.5 / 0.022, rel=0.02)
    assert across < 1e-10


def test_a_shape_that_quadratic_elements_cannot_follow_is_told_with_a_mesh_that_can() -> None:
    patch = films.flat((12, 4))
    shell, shapes = films.shell(patch), np.stack([bent(patch, k) for k in (0.01, 0.5, 0.1)])
    (warning,) = locked(shell, shapes)
    finer = int(warning.partition("take about ")[2].split()[0])
    assert "12 quadratic elements along X" in warning
    again = films.flat((finer, 4))
    assert sag(films.shell(again), bent(again, 0.5))[0] < LARGEST
    assert not list(locked(films.shell(again), bent(again, 0.5)[None]))


def test_cubic_elements_are_not_told_of() -> None:
    patch = films.flat((12, 4), degree=3)
    assert not list(locked(films.shell(patch), bent(patch, 2.0)[None]))
