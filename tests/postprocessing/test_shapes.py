"""Measures of a film without cells: rolled to a known curvature."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from pipeline.running.memory import MemoryRun
from stages.artefacts import Deformation, Equilibria, MidSurface
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid
from stages.postprocessing.config import ShapeConfig
from stages.postprocessing.stage import shape

LENGTH, WIDTH = 4.0, 3.0
FILM = Patch.rectangle(LENGTH, WIDTH).refine(3, (40, 4))
GRID = quadrature_grid(FILM, 4)
CONFIG = ShapeConfig(
    probes={"A": "centre", "B": "tip", "C": "corner", "D": (1.0, 0.75)}, mid_axis="middle"
)


def rolled(curvatures: list[float]) -> Equilibria:
    """Shapes of equal curvature; the fields are linear along X and grow with time."""
    points = FILM.evaluate(*(space.greville() for space in FILM.spaces))
    x = points[:, 0]
    frames = []
    for k in curvatures:
        arc = np.stack((np.sin(k * x) / k, points[:, 1], (1 - np.cos(k * x)) / k), axis=-1)
        frames.append((FILM.interpolate(arc).control_points - FILM.control_points).reshape(-1, 3))
    count = np.arange(1.0, len(curvatures) + 1)
    along = np.repeat(GRID.theta1, GRID.theta2.size)
    scalar = np.zeros(count.size)
    return Equilibria(
        time=count,
        displacement=np.stack(frames),
        strain_energy=scalar,
        external_work=scalar,
        newton_iterations=scalar,
        load_step=scalar,
        load_factor=scalar + 1.0,
        unstable_directions=scalar,
        limit_loads=scalar[:0],
        bifurcation_loads=scalar[:0],
        fibre_stretch=1.0 - 0.01 * np.outer(count, along),
        active_stress=np.outer(count, 1.0 + along),
    )


def tip(k: float) -> Array:
    """Displacement of the end of an arc."""
    return np.array([np.sin(k * LENGTH) / k - LENGTH, 0.0, (1 - np.cos(k * LENGTH)) / k])


def test_probes_tip_and_curvature_of_rolled_films() -> None:
    measures = shape.compute(CONFIG, MidSurface(FILM), rolled([0.2, 0.5]))
    np.testing.assert_allclose(
        measures.probe_points[:, :2], [[2.0, 1.5], [4.0, 1.5], [4.0, 3.0], [1.0, 0.75]], atol=1e-12
    )
    # cubic interpolation of arcs with h k = 0.05: (h k)^4/4! R or so
    np.testing.assert_allclose(measures.curvature, [0.2, 0.5], rtol=1e-6)
    np.testing.assert_allclose(measures.tip, [tip(0.2), tip(0.5)], atol=1e-6)
    np.testing.assert_allclose(measures.displacement[:, 1], measures.tip, atol=1e-14)
    np.testing.assert_allclose(measures.turning, np.rad2deg([0.8, 2.0]), rtol=1e-5)


def test_fields_at_probes_are_those_of_the_gauss_points() -> None:
    measures = shape.compute(CONFIG, MidSurface(FILM), rolled([0.2, 0.5]))
    theta = np.array([0.5, 1.0, 1.0, 0.25])
    # linear fields are splines: round-off only
    np.testing.assert_allclose(measures.fibre_stretch[1], 1.0 - 0.02 * theta, atol=1e-12)
    np.testing.assert_allclose(measures.active_stress[0], 1.0 + theta, atol=1e-12)
    np.testing.assert_allclose(measures.mean_active_stress, [1.5, 3.0], rtol=1e-12)


@pytest.mark.parametrize(("curvature", "touches"), [(1.5, False), (1.6, True)])
def test_a_film_that_swings_beyond_a_full_circle_is_told(curvature: float, touches: bool) -> None:
    shapes = rolled([0.2, curvature])
    names = {field.name for field in fields(Deformation)}
    known = {name: getattr(shapes, name) for name in names & set(vars(shapes))}
    moving = Deformation(**dict.fromkeys(names, shapes.strain_energy) | known)
    run = MemoryRun()
    shape.compute(CONFIG, MidSurface(FILM), moving, run=run)
    assert [("full circle" in w, "t = 2 ms" in w) for w in run.warnings] == [(True, True)] * touches
    silent = MemoryRun()
    shape.compute(CONFIG, MidSurface(FILM), shapes, run=silent)  # its own stage has told
    assert silent.warnings == []
