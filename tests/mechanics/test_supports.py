"""Supports: what they hold, and what they leave free."""

from __future__ import annotations

import numpy as np
import pytest

from stages.mechanics.supports import fixed_degrees
from stages.numerics.patches import Patch
from tests.mechanics import films


def test_a_clamp_holds_two_rows_of_control_points() -> None:
    fixed = fixed_degrees(films.flat((4, 2)), "clamped").reshape(6, 4, 3)
    assert fixed[:2].all()
    assert not fixed[2:].any()


def test_a_clamp_of_the_normal_lets_the_edge_stretch() -> None:
    fixed = fixed_degrees(films.flat((4, 2)), "clamped-normal").reshape(6, 4, 3)
    assert fixed[0].all()
    assert fixed[1, :, 2].all()
    assert not fixed[1, :, :2].any()
    assert not fixed[2:].any()


@pytest.mark.parametrize("support", ["clamped", "clamped-normal"])
def test_a_held_film_has_no_rigid_motion_left(support: str) -> None:
    body = films.shell(films.flat((3, 2)))
    matrix = body.stiffness_at_rest().supported(fixed_degrees(body.patch, support))
    assert matrix.factorise().positive_definite


def test_both_clamps_hold_the_rotation_of_the_edge() -> None:
    """The normal at X = 0 depends on the held components only: u_z,X is zero there."""
    patch = films.flat((3, 2))
    displacement = np.random.default_rng(0).normal(size=patch.control_points.shape)
    displacement[fixed_degrees(patch, "clamped-normal").reshape(displacement.shape)] = 0.0
    moved = Patch(patch.first, patch.second, displacement)
    slope = moved.evaluate([0.0], np.linspace(0, 1, 5).tolist(), (1, 0))
    # products of zeros with basis functions
    assert np.abs(slope[:, 2]).max() < 1e-14


def test_the_normal_of_a_tilted_edge_is_refused_with_the_remedy() -> None:
    patch = films.flat((3, 2))
    tilted = Patch(patch.first, patch.second, patch.control_points @ films.rotation(1).T)
    with pytest.raises(ValueError, match="use 'clamped' on this film"):
        fixed_degrees(tilted, "clamped-normal")


def test_an_unknown_support_is_refused_with_the_names_on_offer() -> None:
    with pytest.raises(ValueError, match="choose one of: clamped, clamped-normal"):
        fixed_degrees(films.flat((3, 2)), "hinged")
