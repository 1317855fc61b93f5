"""Supports: what they hold, and what they leave free."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import ValidationError

from stages.mechanics.config import EquilibriumConfig
from stages.mechanics.constraints import fixed_degrees
from stages.mechanics.supports.base import Support
from stages.mechanics.supports.clamped import Clamped
from stages.mechanics.supports.clamped_normal import ClampedNormal
from stages.mechanics.supports.free import Free
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.mechanics import films

CLAMPS = [Clamped(edge="X=0"), ClampedNormal(edge="X=0")]


def held_by(patch: Patch, support: Support) -> Array:
    return fixed_degrees(patch, {"support": support}).reshape(patch.control_points.shape)


@pytest.mark.parametrize(
    ("edge", "rows"),
    [
        ("X=0", np.s_[:2]),
        ("X=L1", np.s_[-2:]),
        ("Y=0", np.s_[:, :2]),
        ("Y=L2", np.s_[:, -2:]),
    ],
)
def test_a_clamp_holds_two_rows_of_control_points(edge: str, rows: tuple[slice, ...]) -> None:
    fixed = held_by(films.flat((4, 3)), Clamped(edge=edge))
    expected = np.zeros_like(fixed)
    expected[rows] = True
    np.testing.assert_array_equal(fixed, expected)


def test_a_clamp_of_the_normal_lets_the_edge_stretch() -> None:
    fixed = held_by(films.flat((4, 2)), ClampedNormal(edge="X=0"))
    assert fixed[0].all()
    assert fixed[1, :, 2].all()
    assert not fixed[1, :, :2].any()
    assert not fixed[2:].any()


@pytest.mark.parametrize("support", CLAMPS, ids=lambda s: s.kind)
def test_a_held_film_has_no_rigid_motion_left(support: Support) -> None:
    body = films.shell(films.flat((3, 2)))
    matrix = body.stiffness_at_rest().supported(held_by(body.patch, support).ravel())
    assert matrix.factorise().positive_definite


def test_both_clamps_hold_the_rotation_of_the_edge() -> None:
    """The normal at X = 0 depends on the held components only: u_z,X is zero there."""
    patch = films.flat((3, 2))
    displacement = np.random.default_rng(0).normal(size=patch.control_points.shape)
    displacement[held_by(patch, ClampedNormal(edge="X=0"))] = 0.0
    moved = Patch(patch.first, patch.second, displacement)
    slope = moved.evaluate([0.0], np.linspace(0, 1, 5).tolist(), (1, 0))
    # products of zeros with basis functions
    assert np.abs(slope[:, 2]).max() < 1e-14


def test_the_normal_of_a_tilted_edge_is_refused_with_the_remedy() -> None:
    patch = films.flat((3, 2))
    tilted = Patch(patch.first, patch.second, patch.control_points @ films.rotation(1).T)
    with pytest.raises(ValueError, match="use 'clamped' on this film"):
        held_by(tilted, ClampedNormal(edge="X=0"))


def test_a_support_that_is_switched_off_holds_nothing() -> None:
    assert not held_by(films.flat((3, 2)), Free(edge="X=0")).any()


def test_an_unknown_kind_is_refused_with_the_kinds_on_offer() -> None:
    with pytest.raises(ValidationError, match="choose one of: clamped, clamped-normal"):
        EquilibriumConfig(
            elements=(3, 2),
            degree=2,
            n_steps=1,
            duration=1.0,
            supports={"clamp": {"kind": "glued", "edge": "X=0"}},
            substrate=films.PDMS,
            active=films.MUSCLE,
        )
