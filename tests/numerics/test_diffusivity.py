"""Fibres in surfaces and the diffusivity along them: exact derivatives, and the operator they make."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from stages.numerics.bsplines import Array
from stages.numerics.collocation import CollocationOperators, collocate
from stages.numerics.diffusivity import along_fibres, fibre_tensor
from stages.numerics.fibres import fibre_field
from stages.numerics.patches import Patch
from stages.numerics.shapes import cylindrical_panel, spherical_panel
from stages.numerics.surface_geometry import frame_at
from tests.problems import observed_orders, skewed_square

ROOT = Path(__file__).parents[2]

SURFACES = {
    "skewed": skewed_square(),
    "cylinder": cylindrical_panel(2.0, 3.0, (-40.0, 80.0)),
    "sphere": spherical_panel(2.0, (0.0, 90.0), (-30.0, 60.0)),
}
THETA = np.random.default_rng(4).uniform(0.1, 0.9, (20, 2))


def twisted(theta: Array) -> tuple[Array, Array]:
    """A fibre angle that changes from place to place, with its slopes, degrees."""
    angle = 25.0 + 40.0 * theta[:, 0] * theta[:, 1] ** 2
    slopes = np.stack((40.0 * theta[:, 1] ** 2, 80.0 * theta[:, 0] * theta[:, 1]), axis=1)
    return angle, slopes


@pytest.mark.parametrize("patch", SURFACES.values(), ids=SURFACES)
def test_the_derivatives_of_a_fibre_field_are_those_of_its_directions(patch: Patch) -> None:
    step = 1e-5
    found = fibre_field(frame_at(patch, THETA), *twisted(THETA))
    for direction in (0, 1):
        ends = []
        for sign in (-1.0, 1.0):
            moved = THETA.copy()
            moved[:, direction] += sign * step
            ends.append(fibre_field(frame_at(patch, moved), twisted(moved)[0]).direction)
        # central differences of unit vectors: 1e-10 cut off, 1e-11 rounding
        differences = (ends[1] - ends[0]) / (2 * step)
        np.testing.assert_allclose(found.derivatives[:, direction], differences, atol=1e-8)


@pytest.mark.parametrize("patch", SURFACES.values(), ids=SURFACES)
def test_fibres_are_unit_tangents_at_their_angle_from_the_first_direction(patch: Patch) -> None:
    frame = frame_at(patch, THETA)
    f = fibre_field(frame, 35.0).direction
    first = frame.tangents[:, 0] / np.linalg.norm(frame.tangents[:, 0], axis=1)[:, None]
    # rounding of unit vectors
    np.testing.assert_allclose(np.linalg.norm(f, axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose((f * frame.normal).sum(1), 0.0, atol=1e-14)
    np.testing.assert_allclose((f * first).sum(1), np.cos(np.deg2rad(35.0)), rtol=1e-13)
    assert ((f * frame.tangents[:, 1]).sum(1) > 0.0).all()


@pytest.mark.parametrize("patch", SURFACES.values(), ids=SURFACES)
def test_equal_conduction_in_all_directions_is_the_isotropic_operator(patch: Patch) -> None:
    fine = patch.refine(3, (6, 5))
    one, other = collocate(fine), collocate(fine, along_fibres(1.0, 30.0))
    for name in ("laplacian", "flux"):
        a, b = getattr(one, name), getattr(other, name)
        # the fibres' part is multiplied by zero
        assert abs(a - b).max() <= 1e-14 * abs(a).max()


def flat_error(elements: int, degree: int = 4) -> tuple[float, float]:
    """Largest errors of div(D grad v) and of the fluxes on the skewed square, fibres straight at 30 degrees.

    The square's coordinate lines are bent: their angle from X is taken off, place by place, so that the
    fibres are straight and the operator is that of constant coefficients.
    """
    k, angle = 0.3, np.deg2rad(30.0)
    patch = skewed_square().refine(degree, (elements, elements))

    def straight(frame):  # type: ignore[no-untyped-def]
        a1, growth = frame.tangents[:, 0], frame.second[:, 0]
        lean = np.arctan2(a1[:, 1], a1[:, 0])
        turn = (a1[:, :1] * growth[..., 1] - a1[:, 1:2] * growth[..., 0]) / (a1**2).sum(1)[:, None]
        return fibre_tensor(
            frame, fibre_field(frame, 30.0 - np.rad2deg(lean), -np.rad2deg(turn)), k
        )

    operators = collocate(patch, straight)
    x, y = operators.frame.position[:, :2].T
    f = np.array([np.cos(angle), np.sin(angle)])
    tensor = k * np.eye(2) + (1 - k) * np.outer(f, f)
    wave = np.array([2.0, -1.5])
    phase = wave[0] * x + wave[1] * y
    control = spsolve(operators.values.tocsc(), np.sin(phase))
    inside = operators.interior
    exact = -(wave @ tensor @ wave) * np.sin(phase)
    body = np.abs(operators.laplacian @ control - exact)[inside].max()
    normals = {"X=0": (-1, 0), "X=L1": (1, 0), "Y=0": (0, -1), "Y=L2": (0, 1)}
    expected = np.zeros(patch.size)
    for name, normal in normals.items():
        points = operators.edges[name]
        expected[points] += (np.array(normal) @ tensor @ wave) * np.cos(phase[points])
    rim = np.abs(operators.flux @ control - expected).max()
    return float(body), float(rim)


def test_straight_fibres_on_skewed_coordinates_make_the_operator_of_constant_coefficients() -> None:
    """Fluxes on all edges and in all corners too."""
    errors = np.array([flat_error(elements) for elements in (8, 16, 32)])
    # interpolation of degree 4, differentiated twice: order 3; the flux once: order 4
    assert observed_orders(errors[:, 0])[-1] > 2.8
    assert observed_orders(errors[:, 1])[-1] > 3.7
    assert errors[-1].max() < 1e-3


HELIX = 40.0


def on_cylinder(operators: CollocationOperators) -> tuple[Array, Array]:
    """A wave on the unrolled cylinder of radius 2, and div(D grad v) with constant coefficients."""
    x, y, z = operators.frame.position.T
    arc = 2.0 * np.arctan2(y, z)
    f = np.array([np.cos(np.deg2rad(HELIX)), np.sin(np.deg2rad(HELIX))])
    # seen from outside, X forward and the arc to the left of it have the normal outwards
    wave = np.array([1.1, 0.7])
    strength = 0.25 * wave @ wave + 0.75 * (wave @ f) ** 2
    field = np.sin(wave[0] * x + wave[1] * arc)
    return field, -strength * field


def on_sphere(operators: CollocationOperators) -> tuple[Array, Array]:
    """Latitude b on the unit sphere, fibres along meridians (90 degrees from parallels): v = sin b.

    div(D grad v) = (cos b v_b)_b / cos b = -2 sin b: with fibres along meridians nothing else flows.
    """
    height = operators.frame.position[:, 2] / 2.0
    return height, -2.0 * height / 4.0


@pytest.mark.parametrize(
    ("shape", "angle", "solution"), [("cylinder", HELIX, on_cylinder), ("sphere", 90.0, on_sphere)]
)
def test_fibres_on_curved_surfaces_carry_known_waves(
    shape: str, angle: float, solution: Callable[[CollocationOperators], tuple[Array, Array]]
) -> None:
    errors = []
    for elements in (8, 16, 32):
        patch = SURFACES[shape].refine(4, (elements, elements))
        operators = collocate(patch, along_fibres(0.25, angle))
        field, exact = solution(operators)
        control = spsolve(operators.values.tocsc(), field)
        errors.append(np.abs(operators.laplacian @ control - exact)[operators.interior].max())
    # interpolation of degree 4, differentiated twice: order 3 at least
    assert observed_orders(np.array(errors))[-1] > 2.8
    assert errors[-1] < 1e-3


def test_the_tissue_of_the_documentation_has_fibres_that_turn_along_x() -> None:
    text = (ROOT / "docs" / "electrophysiology.md").read_text()
    code = text.split("```python\n")[1].split("```")[0]
    names: dict[str, object] = {"patch": Patch.rectangle(3.5, 2.0).refine(4, (24, 12))}
    exec(code, names)
    operators = names["operators"]
    assert isinstance(operators, CollocationOperators)
    x, y = operators.frame.position[:, :2].T
    turn, angle = np.deg2rad(20.0), np.deg2rad(20.0) * x
    # v = y: the flux along y is D_yy = k + (1 - k) sin^2, along x D_xy = (1 - k) sin cos of the angle
    control = spsolve(operators.values.tocsc(), y)
    found = (operators.laplacian @ control)[operators.interior]
    exact = 0.75 * turn * np.cos(2.0 * angle)
    # v is in the space, derivatives are exact: rounding of second derivatives
    np.testing.assert_allclose(found, exact[operators.interior], atol=1e-9)
