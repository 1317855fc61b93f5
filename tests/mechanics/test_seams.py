"""Tubes are joined at their seam: one smooth line, that neither opens nor kinks."""

from __future__ import annotations

import numpy as np
import pytest

from stages.geometry.config import FilmConfig, MeshConfig
from stages.geometry.films import film_patch
from stages.mechanics.actions.seams import seams
from stages.mechanics.body.constraints import constrain
from stages.mechanics.supports.clamped import Clamped
from stages.numerics.patches import Patch
from stages.numerics.surface_geometry import frame_on_grid

ALONG = np.linspace(0.0, 1.0, 9)


def tube(axis: str, degree: int) -> Patch:
    film = FilmConfig(
        length=3.5,
        width=2.0,
        substrate_thickness=0.018,
        active_thickness=0.004,
        fibre_angle=0.0,
        shape={"name": "tube", "axis": axis},
    )
    return film_patch(film, MeshConfig(elements=(8, 9), degree=degree))


@pytest.mark.parametrize("degree", [2, 3])
@pytest.mark.parametrize("axis", ["X", "Y"])
def test_a_tube_that_moves_has_no_gap_and_no_kink(axis: str, degree: int) -> None:
    patch = tube(axis, degree)
    ties = constrain(patch, {}).ties
    u = 0.02 * np.random.default_rng(3).normal(size=3 * patch.size)
    u = ties.admissible(u, np.zeros(0)).reshape(patch.control_points.shape)
    moved = patch.with_net(patch.control_points + u)
    ends = np.array([0.0]), np.array([1.0])
    both = [frame_on_grid(moved, *((ALONG, at) if axis == "X" else (at, ALONG))) for at in ends]
    np.testing.assert_allclose(both[0].position, both[1].position, atol=1e-14)
    np.testing.assert_allclose(both[0].normal, both[1].normal, atol=1e-11)
    assert np.abs(u).max() > 0.02


def test_a_seam_resists_no_rigid_motion() -> None:
    patch = tube("X", 2)
    net = patch.control_points.reshape(-1, 3)
    turned = np.cross([0.3, -1.0, 0.7], net) + np.array([0.1, 0.2, 0.3])
    for relation in seams(patch):
        # coordinates of 3.5 mm, slopes of tens of mm
        assert abs(np.array(relation.factors) @ turned.ravel()[list(relation.unknowns)]) < 1e-11


def test_a_clamp_may_meet_the_seam() -> None:
    patch = tube("X", 2)
    constraints = constrain(patch, {"clamp": Clamped(edge="X=0")})
    dependent = constraints.ties.dependent.reshape(patch.first.size, patch.second.size, 3)
    assert dependent[:2].all()
    # beyond the clamp two control points of each section follow the others
    assert (dependent[2:, :, 0].sum(axis=1) == 2).all()


def test_an_open_film_has_no_seam() -> None:
    assert not list(seams(Patch.rectangle(1.0, 1.0).refine(2, (3, 3))))
