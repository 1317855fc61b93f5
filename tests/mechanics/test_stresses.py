"""Stress, strain and thickness of deformed shells: thick cylinders, tension, fibres, equal resultants."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import Laminate, Layer
from stages.mechanics.shell.shell import Shell, build_shell
from stages.mechanics.shell.stresses import deformed_thickness, stress_state
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.shapes import cylindrical_panel
from tests.mechanics import films, materials, tensions

THETA = np.linspace(0.0, 1.0, 5)
RADIUS, THICKNESS = 2.0, 0.5


def sheet(name: str, angle: float = 0.0, thickness: float = 0.1) -> Shell:
    """Flat film of one active layer."""
    laminate = Laminate((Layer("sheet", name, thickness, angle, 1.0),))
    return build_shell(films.flat((2, 2)), laminate, materials.every())


def tube(thin: bool = False) -> Shell:
    """Quarter of a thick cylinder along X, R/t = 4, with fibres across its axis."""
    patch = cylindrical_panel(RADIUS, 3.0, (-45.0, 45.0)).refine(3, (2, 2))
    laminate = Laminate(
        (
            Layer("inner", "neo-hookean", 0.2, 90.0, 0.0),
            Layer("outer", "neo-hookean", 0.3, 90.0, 0.0),
        )
    )
    return build_shell(patch, laminate, materials.EXAMPLES, thin=thin)


def inflated(shell: Shell, factor: float) -> Array:
    """Every radius of the mid-surface times ``factor``; the axis keeps its length."""
    return np.array(shell.patch.control_points * [0.0, factor - 1.0, factor - 1.0]).ravel()


@pytest.mark.parametrize("factor", [0.9, 1.05, 1.3])
@pytest.mark.parametrize(
    ("layer", "bottom", "top"), [("inner", -0.25, -0.05), ("outer", -0.05, 0.25)]
)
def test_an_inflated_thick_cylinder_has_its_exact_strain_at_every_depth(
    factor: float, layer: str, bottom: float, top: float
) -> None:
    """Along the arc (R' + z)/(R + z), quadratic in neither eps nor kappa: the shell has it exactly."""
    shell = tube()
    for level in (0.0, 0.3, 1.0):
        z = bottom + level * (top - bottom)
        exact = (factor * RADIUS + z) / (RADIUS + z)
        state = stress_state(shell, inflated(shell, factor), THETA, THETA, layer=layer, level=level)
        # curvatures of a rational cubic panel, refined: some 1e2 roundings
        np.testing.assert_allclose(state.fibre_stretch, exact, rtol=1e-12)
        np.testing.assert_allclose(state.thickness_stretch, 1.0 / exact, rtol=1e-12)
        # plane strain along the axis: sigma = mu (l^2 - 1/l^2) along the arc, mu (1 - 1/l^2) across
        expected = [500.0 * (exact**2 - exact**-2), 500.0 * (1 - exact**-2), 0.0]
        np.testing.assert_allclose(state.cauchy, np.tile(expected, (25, 1)), rtol=1e-9, atol=1e-8)


def test_the_classical_thin_shell_takes_the_lengths_of_the_mid_surface() -> None:
    """Its strain along the arc is measured by R^2 at every depth: E = (R'^2 - R^2 + 2 z (R' - R))/2."""
    shell, z, larger = tube(thin=True), 0.25, 1.1 * RADIUS
    state = stress_state(shell, inflated(shell, 1.1), THETA, THETA, layer="outer", level=1.0)
    strain = 0.5 * (larger**2 - RADIUS**2) + z * (larger - RADIUS)
    np.testing.assert_allclose(
        state.fibre_stretch, np.sqrt(1.0 + 2.0 * strain / RADIUS**2), rtol=1e-12
    )


def test_the_wall_of_an_inflated_cylinder_grows_thinner() -> None:
    """Integral of (R + z)/(R' + z) over z: t - (R' - R) log((R' + t/2)/(R' - t/2))."""
    shell, larger = tube(), 1.05 * RADIUS
    half = 0.5 * THICKNESS
    exact = THICKNESS - (larger - RADIUS) * np.log((larger + half) / (larger - half))
    # three Gauss points through each layer: 1e-9 of a function that varies by 5 %
    np.testing.assert_allclose(
        deformed_thickness(shell, inflated(shell, 1.05), THETA, THETA), exact, rtol=1e-9
    )


@pytest.mark.parametrize("name", materials.NAMES)
def test_a_sheet_in_tension_has_one_stress_and_the_thickness_of_its_law(name: str) -> None:
    stretch = 1.1
    contraction = 1 - 0.6 * 0.5 * (stretch**2 - 1) if name == "st-venant-kirchhoff" else 1 / stretch
    shell = sheet(name)
    net = shell.patch.control_points
    moved = net * [stretch - 1.0, np.sqrt(contraction) - 1.0, 0.0]
    state = stress_state(shell, moved.ravel(), THETA, THETA, layer="sheet")
    axial = state.cauchy[:, 0]
    assert axial.min() > 0
    # round-off of a uniform field
    assert np.ptp(axial) < 1e-11 * axial.max()
    assert np.abs(state.cauchy[:, 1:]).max() < 1e-11 * axial.max()
    np.testing.assert_allclose(state.thickness_stretch, np.sqrt(contraction), rtol=1e-13)
    thickness = deformed_thickness(shell, moved.ravel(), THETA, THETA)
    np.testing.assert_allclose(thickness, 0.1 * np.sqrt(contraction), rtol=1e-13)


@pytest.mark.parametrize("angle", [0.0, 30.0, -75.0])
def test_the_active_stress_is_the_cauchy_stress_along_the_fibres(angle: float) -> None:
    """sigma = sigma_a f (x) f on a film at rest: seen along X it is turned by the angle."""
    shell = sheet("neo-hookean", angle)
    at = (shell, np.zeros(shell.size), THETA, THETA)
    along = stress_state(*at, layer="sheet", activation=9.0)
    np.testing.assert_allclose(along.cauchy, np.tile([9.0, 0.0, 0.0], (25, 1)), atol=1e-13)
    np.testing.assert_allclose(along.active_stress, 9.0, rtol=1e-15)
    c, s = np.cos(np.deg2rad(angle)), np.sin(np.deg2rad(angle))
    np.testing.assert_allclose(along.directions[0], [[c, s, 0.0], [-s, c, 0.0]], atol=1e-14)
    seen = stress_state(*at, layer="sheet", activation=9.0, angle=0.0)
    expected = [9.0 * c * c, 9.0 * s * s, 9.0 * c * s]
    np.testing.assert_allclose(seen.cauchy, np.tile(expected, (25, 1)), atol=1e-13)


def test_stresses_through_the_thickness_integrate_to_the_shells_resultants() -> None:
    """n^ab and m^ab of the compiled shell, from the states at its own points and depths."""
    patch, law = films.arched((2, 2)), tensions.example("length-dependent")
    shell = build_shell(patch, films.two_layers(), films.MATERIALS, tension=law)
    displacement, activation = films.random_state(shell, seed=12)
    grid = quadrature_grid(patch, 3)
    force, moment = np.zeros((shell.points, 3)), np.zeros((shell.points, 3))
    for points in shell.layers:
        depths = points.depth - (points.depth.mean() - 0.5 * points.layer.thickness)
        for z, w, up in zip(points.depth, points.weights, depths, strict=True):
            state = stress_state(
                shell,
                displacement,
                grid.theta1,
                grid.theta2,
                layer=points.layer.name,
                level=float(up / points.layer.thickness),
                activation=activation,
            )
            force += w * state.second_piola
            moment += w * z * state.second_piola
    found = shell.respond(displacement, activation).resultants
    # the same laws on metrics formed in another order, in a state of large strains
    assert np.abs(found.force - force).max() < 1e-11 * np.abs(force).max()
    assert np.abs(found.moment - moment).max() < 1e-11 * np.abs(moment).max()


def test_a_place_outside_the_film_is_refused() -> None:
    shell = sheet("neo-hookean")
    at = (shell, np.zeros(shell.size), THETA, THETA)
    with pytest.raises(
        ValueError, match=r"no layer 'muscle'; from bottom to top there are 'sheet'"
    ):
        stress_state(*at, layer="muscle")
    with pytest.raises(ValueError, match=r"level 1\.5 lies outside the layer"):
        stress_state(*at, layer="sheet", level=1.5)


@pytest.mark.parametrize(
    "patch", [films.flat((3, 2)), films.arched((3, 2))], ids=["flat", "arched"]
)
def test_the_recorded_stretch_of_the_fibres_is_the_one_at_mid_depth_of_the_muscle(
    patch: Patch,
) -> None:
    """Fibres across the axes, on a sheared and bent film; the laws are those of the film."""
    body = films.shell(patch, films.two_layers(angle=30.0))
    grid = quadrature_grid(patch, body.basis.points)
    u = 0.02 * np.random.default_rng(1).normal(size=body.size)
    found = body.fibre_stretch(u)
    top = films.two_layers().layers[-1].name
    state = stress_state(body, u, grid.theta1, grid.theta2, layer=top)
    assert np.ptp(found) > 0.01
    # two ways to the same sum
    np.testing.assert_allclose(found, state.fibre_stretch, rtol=1e-12)
