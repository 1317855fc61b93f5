"""Closed forms of the bending film: against beam theory, and against each other."""

from __future__ import annotations

import numpy as np
import pytest

from workflows.theory.bilayer import (
    Ply,
    cylindrical,
    free_strip,
    prescribed,
    resultants,
)


def film(stress: float) -> list[Ply]:
    """The film of the paper (Table 1) under a prescribed active stress."""
    return [Ply(0.018, 500.0), Ply(0.004, 0.767, 21.0, 5.5, prescribed(stress))]


def test_a_weakly_pulled_strip_bends_as_a_composite_beam() -> None:
    """Both plies are incompressible and contract across alike, so that beam theory is exact."""
    stress = 1e-4
    modulus, depth = np.array([1500.0, 3 * 0.767 + 21.0]), np.array([0.018, 0.004])
    z = np.array([-0.002, 0.009])  # middle of each ply, from the middle of the film
    a, b, d = ((modulus * depth * f).sum() for f in (1.0, z, z**2 + depth**2 / 12))
    force = -stress * depth[1] * np.array([1.0, z[1]])
    strain, change = np.linalg.solve([[a, b], [b, d]], force)  # e = strain + z change
    bend = free_strip(film(stress))
    # strains are 3e-8, so quadratic terms are far below; the solver leaves 1e-13 of the stiffness
    assert bend.curvature_x == pytest.approx(-change, rel=1e-5)
    assert bend.stretch_x - 1.0 == pytest.approx(strain, rel=1e-5)
    assert bend.curvature_y == pytest.approx(0.5 * change, rel=1e-5)


@pytest.mark.parametrize("stress", [2.8, 12.2, 60.0])
def test_the_free_strip_is_in_balance_and_the_cylinder_resists_curling_across(
    stress: float,
) -> None:
    plies = film(stress)
    free = resultants(plies, free_strip(plies))
    scale = stress * 0.004
    # the solver leaves 1e-13 of the stiffness, 27 kPa mm, and 3e-14 of its product with d/2
    assert np.abs(free[:2]).max() < 1e-9 * scale
    assert np.abs(free[2:]).max() < 1e-9 * scale * 0.011
    held = resultants(plies, cylindrical(plies))
    assert abs(held[3]) > 0.1 * scale * 0.009


def test_a_wide_film_has_three_quarters_of_the_curvature_of_a_narrow_one() -> None:
    for stress in (2.8, 12.2, 30.0):
        ratio = cylindrical(film(stress)).curvature_x / free_strip(film(stress)).curvature_x
        # 3/4 but for the passive stiffness of the muscle and for finite strains
        assert ratio == pytest.approx(0.75, abs=0.01)


def test_a_stress_beyond_the_film_is_refused() -> None:
    with pytest.raises(ValueError, match="no uniform bend"):
        free_strip([Ply(0.001, 0.01), Ply(0.1, 0.001, tension=prescribed(1e6))])
