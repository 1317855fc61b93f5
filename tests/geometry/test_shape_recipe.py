"""The recipe of the contributing guide for a shape works as printed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from stages.geometry import shapes
from stages.geometry.config import FilmConfig, MeshConfig
from stages.geometry.films import active_mid_surface, film_patch
from stages.numerics.film_lengths import FilmLengths
from stages.numerics.surface_geometry import frame_on_grid
from tests.mechanics.test_recipes import follow


def test_a_shape_is_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    follow(shapes, "Film that hangs like a chain", tmp_path, monkeypatch)
    film = FilmConfig(
        length=3.5,
        width=2.0,
        substrate_thickness=0.018,
        active_thickness=0.004,
        fibre_angle=0.0,
        shape={"name": "catenary", "radius": 1.2},
    )
    mesh = MeshConfig(elements=(60, 4), degree=3)
    patch = film_patch(film, mesh)
    (theta,) = FilmLengths(patch).parameters(np.array([(1.75 + 0.9, 0.5)]))
    lowest = patch.evaluate_points(theta[None])
    # cubics over spans of 50 mrad: h^4/24
    np.testing.assert_allclose(
        lowest, [[1.2 * np.arcsinh(0.75), 0.5, np.hypot(0.9, 1.2)]], atol=1e-6
    )
    frame = frame_on_grid(active_mid_surface(film, mesh).patch, np.array([0.5]), np.array([0.5]))
    np.testing.assert_allclose(frame.position, [[0.0, 1.0, 1.209]], atol=1e-6)
