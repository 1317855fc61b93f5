"""Force and tangent of the shell: derivatives, symmetry, rigid motions, patch test, layers."""

from __future__ import annotations

import numpy as np
import pytest

from stages.artefacts import Laminate, Layer
from stages.mechanics.shell.shell import Shell, build_shell
from stages.numerics.bsplines import SplineSpace
from stages.numerics.patches import Patch
from stages.numerics.quadrature import quadrature_grid
from stages.numerics.shapes import cylindrical_panel
from stages.numerics.surface_geometry import frame_on_grid
from tests.mechanics import films, materials, twin

FILMS = {
    "flat": films.flat((3, 2)),
    "cubic": films.flat((2, 2), degree=3),
    "uneven": films.uneven(),
    "arched": films.arched((3, 2)),
    "mixed": films.mixed(),
    "rational": films.rational(),
}


@pytest.fixture(params=FILMS, scope="module")
def body(request: pytest.FixtureRequest) -> Shell:
    return films.shell(FILMS[request.param])


def directions(body: Shell, count: int) -> np.ndarray:
    return np.random.default_rng(7).normal(size=(count, body.size))


def test_the_tangent_is_the_derivative_of_the_force(body: Shell) -> None:
    state, activation = films.random_state(body, seed=1)
    matrix = body.tangent(body.respond(state, activation)).dense()
    step = 1e-6
    for d in directions(body, 3):
        ahead = body.respond(state + step * d, activation).force
        behind = body.respond(state - step * d, activation).force
        difference = (ahead - behind) / (2 * step)
        # central differences: truncation ~ step^2 and round-off ~ 1e-16/step stay below 1e-7
        assert np.abs(matrix @ d - difference).max() < 1e-6 * np.abs(difference).max()


def test_the_passive_force_is_the_derivative_of_the_energy(body: Shell) -> None:
    state, _ = films.random_state(body, seed=2)
    silent = np.zeros(body.points)
    force = body.respond(state, silent).force
    step = 1e-5
    for d in directions(body, 3):
        ahead = body.respond(state + step * d, silent).energy
        behind = body.respond(state - step * d, silent).energy
        # the energy is known to 1e-15 relative; over 2e-5 that leaves about 1e-9 of the force
        assert force @ d == pytest.approx((ahead - behind) / (2 * step), rel=1e-6)


def test_the_active_tangent_is_symmetric_although_stress_follows_the_fibres(body: Shell) -> None:
    """The band holds one triangle; the other one must be the same derivative."""
    state, activation = films.random_state(body, seed=3)
    a, b = directions(body, 2)
    step = 1e-6

    def along(d: np.ndarray) -> np.ndarray:
        ahead, behind = (body.respond(state + s * d, activation).force for s in (step, -step))
        return (ahead - behind) / (2 * step)

    # two independent differences, each good to 1e-7 of its size
    assert b @ along(a) == pytest.approx(a @ along(b), rel=1e-5)


def test_rigid_motions_cause_no_force(body: Shell) -> None:
    net = body.patch.control_points.reshape(-1, 3)
    moved = net @ films.rotation(4).T + [0.3, -1.0, 2.0]
    response = body.respond((moved - net).ravel(), np.zeros(body.points))
    stiffness = body.stiffness_at_rest().diagonal.max()
    # positions of a few mm are rounded to 1e-15 mm; the stiffest entry turns that into force
    assert np.abs(response.force).max() < 1e-14 * stiffness
    assert abs(response.energy) < 1e-15


def test_force_and_energy_turn_with_the_body(body: Shell) -> None:
    state, activation = films.random_state(body, seed=5)
    net = body.patch.control_points.reshape(-1, 3)
    turn = films.rotation(6)
    turned = (net + state.reshape(-1, 3)) @ turn.T - net
    straight = body.respond(state, activation)
    rotated = body.respond(turned.ravel(), activation)
    expected = straight.force.reshape(-1, 3) @ turn.T
    # objectivity up to round-off of the rotated positions
    assert np.abs(rotated.force.reshape(-1, 3) - expected).max() < 1e-11 * np.abs(expected).max()
    assert rotated.energy == pytest.approx(straight.energy, rel=1e-12)


def test_rest_without_activation_is_free_of_force_exactly(body: Shell) -> None:
    response = body.respond(np.zeros(body.size), np.zeros(body.points))
    assert not response.force.any()
    assert response.energy == 0.0


def test_the_compiled_kernels_equal_their_plain_numpy_twin(body: Shell) -> None:
    compare_with_twin(body)


@pytest.mark.parametrize("name", materials.every())
def test_the_kernels_of_every_material_equal_the_twin(name: str) -> None:
    laws = {"substrate": films.PDMS, "active": materials.every()[name]}
    compare_with_twin(build_shell(films.arched((2, 2)), films.two_layers(), laws))


def compare_with_twin(body: Shell) -> None:
    state, activation = films.random_state(body, seed=8)
    response = body.respond(state, activation)
    force, matrix, energy = twin.respond(body, state, activation)
    # the same sums in another order: round-off of a few hundred terms
    assert np.abs(response.force - force).max() < 1e-12 * np.abs(force).max()
    difference = np.abs(body.tangent(response).dense() - matrix).max()
    assert difference < 1e-12 * np.abs(matrix).max()
    assert response.energy == pytest.approx(energy, rel=1e-13)


def test_a_uniform_stretch_is_reproduced_on_any_knot_vector() -> None:
    """Patch test: a linear displacement gives the same n^ab at every point, and no inner force."""
    body = films.shell(films.uneven())
    net = body.patch.control_points.reshape(-1, 3)
    stretch = np.array([[1.05, 0.02, 0.0], [0.01, 0.97, 0.0], [0.0, 0.0, 1.0]])
    response = body.respond((net @ stretch.T - net).ravel(), np.zeros(body.points))
    forces = response.resultants.force
    # theta runs over the unit square, so components are constant; knots add round-off only
    assert np.ptp(forces, axis=0).max() < 1e-12 * np.abs(forces).max()
    nodal = response.force.reshape(*body.patch.control_points.shape)
    inner = np.abs(nodal[1:-1, 1:-1, :2]).max()
    assert inner < 1e-12 * np.abs(nodal[..., :2]).max()


def test_a_layer_may_be_split_in_two_equal_ones() -> None:
    patch = films.arched((3, 2))
    whole = films.shell(patch)
    halves = Laminate(
        (
            Layer("substrate", "substrate", 0.018, 45.0, 0.0),
            Layer("lower", "active", 0.002, 45.0, 1.0),
            Layer("upper", "active", 0.002, 45.0, 1.0),
        )
    )
    split = build_shell(patch, halves, films.MATERIALS)
    state, activation = films.random_state(whole, seed=9)
    one, two = whole.respond(state, activation), split.respond(state, activation)
    # three Gauss points integrate a 4 um layer to a relative error far below 1e-9
    assert np.abs(one.force - two.force).max() < 1e-9 * np.abs(one.force).max()
    assert two.energy == pytest.approx(one.energy, rel=1e-9)


def test_the_mass_matrix_holds_the_mass_of_the_film_in_each_direction(body: Shell) -> None:
    ones = np.tile([1.0, 0.0, 0.0], body.patch.size)
    grid = quadrature_grid(body.patch, body.basis.points)
    area = (grid.weights1[:, None] * grid.weights2).ravel() @ frame_on_grid(
        body.patch, grid.theta1, grid.theta2
    ).area
    # the functions sum to one, so this is rho d times the area (eq. 104); sums of 1e3 terms
    assert ones @ (body.mass() @ ones) == pytest.approx(0.965 * 0.022 * area, rel=1e-12)


@pytest.mark.parametrize("patch", [films.flat((3, 2)), films.uneven()])
def test_the_area_of_a_flat_film_is_its_length_times_its_width(patch: Patch) -> None:
    # a constant area element, integrated to round-off
    assert films.shell(patch).weights.sum() == pytest.approx(3.5 * 2.0, rel=1e-13)


def test_a_film_that_is_not_smooth_is_refused() -> None:
    with pytest.raises(ValueError, match="C1: direction 1 has degree 1"):
        films.shell(films.flat().rectangle(3.5, 2.0))


def test_a_layer_without_material_is_refused() -> None:
    with pytest.raises(ValueError, match="layer 'active' is of material 'active', which is not"):
        build_shell(films.flat((2, 2)), films.two_layers(), {"substrate": films.PDMS})


@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_turning_a_film_in_space_takes_its_fibres_along(angle: float) -> None:
    """Fibres are counted from the film's own X, so that a film may stand upright or be rolled up."""
    patch = films.arched((3, 2))
    upright = patch.with_net(patch.control_points[..., [2, 0, 1]])
    lying, standing = (films.shell(p, films.two_layers(angle=angle)) for p in (patch, upright))
    for a, b in zip(lying.layers, standing.layers, strict=True):
        # the same products in another order
        np.testing.assert_allclose(a.reference, b.reference, rtol=1e-12, atol=1e-14)


def test_the_mass_matrix_is_the_integral_of_products_of_the_functions(body: Shell) -> None:
    grid = quadrature_grid(body.patch, body.basis.points)
    pairs = np.stack(np.meshgrid(grid.theta1, grid.theta2, indexing="ij"), axis=-1)
    functions = body.patch.functions(pairs.reshape(-1, 2))
    expected = functions.T @ (body.weights[:, None] * functions)
    mass = body.mass().dense()
    density = mass.sum() / (3 * expected.sum())
    for x in range(3):
        # the same sums in another order
        np.testing.assert_allclose(
            mass[x::3, x::3], density * expected, rtol=0, atol=1e-13 * mass.max()
        )
    assert not mass[0::3, 1::3].any()
    total = sum(p.material.density * p.layer.thickness for p in body.layers)
    assert density == pytest.approx(total, rel=1e-12)


def test_equal_weights_leave_force_and_tangent_as_they_were() -> None:
    plain = films.arched((3, 2))
    weights = np.full(plain.control_points.shape[:2], 0.7)
    patches = plain, Patch(plain.first, plain.second, plain.control_points, weights)
    bodies = [films.shell(patch) for patch in patches]
    state, activation = films.random_state(bodies[0], seed=11)
    responses = [body.respond(state, activation) for body in bodies]
    # the division by a constant W rounds each function once more
    scale = np.abs(responses[0].force).max()
    assert np.abs(responses[0].force - responses[1].force).max() < 1e-12 * scale
    tangents = [body.tangent(r).bands for body, r in zip(bodies, responses, strict=True)]
    assert np.abs(tangents[0] - tangents[1]).max() < 1e-12 * np.abs(tangents[0]).max()


def test_a_circle_of_two_segments_is_refused_because_its_splines_have_kinks() -> None:
    """The geometry is smooth, but displacements over a double knot would be C0."""
    panel = cylindrical_panel(1.0, 2.0, (0.0, 90.0))
    knots = np.array([0, 0, 0, 0.5, 0.5, 1, 1, 1])
    root = np.sqrt(0.5)
    arc = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]])
    net = np.zeros((2, 5, 3))
    net[1, :, 0] = 2.0
    net[..., 2], net[..., 1] = arc.T
    weights = np.tile([1, root, 1, root, 1], (2, 1))
    half = Patch(panel.first, SplineSpace(2, knots), net, weights).refine(2, (2, 2))
    with pytest.raises(ValueError, match="direction 2 has degree 2 and continuity C0"):
        films.shell(half)
