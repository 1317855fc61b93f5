"""Any lay-up of any materials: splitting, turning, mirroring; forces first, then whole equilibria."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from stages.artefacts import Laminate, Layer
from stages.mechanics.shell.shell import Shell, build_shell
from stages.mechanics.tension_laws.base import TensionLaw
from stages.numerics.bsplines import Array
from stages.numerics.patches import Patch
from tests.mechanics import films, materials, tensions
from tests.mechanics.load_path import LoadPath

SMALL = films.flat((2, 2))
SQUARE = films.flat((3, 3), length=2.0, width=2.0)
TENSION = tensions.example("length-dependent")
THICKNESS = st.floats(0.002, 0.01)
ANGLE = st.floats(-90.0, 90.0)
ISOTROPIC = ("neo-hookean", "st-venant-kirchhoff")
PASSIVE = ("neo-hookean", "st-venant-kirchhoff")  # active or passive: a kernel less to compile
SEEDS = st.integers(0, 2**32 - 1)


@st.composite
def laminates(draw: st.DrawFn) -> Laminate:
    """One to four layers of any material, some active."""
    names = draw(st.lists(st.sampled_from(materials.NAMES), min_size=1, max_size=4))
    return Laminate(
        tuple(
            Layer(
                f"layer {i}",
                name,
                draw(THICKNESS),
                draw(ANGLE),
                0.0 if name in PASSIVE else draw(st.sampled_from((0.5, 1.0))),
            )
            for i, name in enumerate(names)
        )
    )


def built(patch: Patch, laminate: Laminate, tension: TensionLaw = TENSION) -> Shell:
    return build_shell(patch, laminate, materials.EXAMPLES, tension=tension)


def state(body: Shell, seed: int) -> tuple[Array, Array]:
    """Stretched by 5 per cent, strained and bent at random by some more, with an activation."""
    u, activation = films.random_state(body, seed, size=0.003)
    return u + 0.05 * body.patch.control_points.ravel(), activation


def assert_equal_forces(found: Array, expected: Array, rtol: float) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=rtol * np.abs(expected).max())


@settings(deadline=None, max_examples=10)
@given(parts=st.lists(THICKNESS, min_size=2, max_size=5), angle=ANGLE, seed=SEEDS)
@pytest.mark.parametrize("name", materials.NAMES)
def test_equal_layers_are_one_layer(name: str, parts: list[float], angle: float, seed: int) -> None:
    whole = built(
        films.arched((2, 2)),
        Laminate((Layer("whole", name, sum(parts), angle, float(name not in PASSIVE)),)),
    )
    split = built(
        whole.patch,
        Laminate(
            tuple(
                Layer(f"{i}", name, part, angle, whole.layers[0].layer.activity)
                for i, part in enumerate(parts)
            )
        ),
    )
    u, activation = state(whole, seed)
    one, many = whole.respond(u, activation), split.respond(u, activation)
    # three Gauss points, through strains that vary by 1e-3 over the film: far beyond 1e-9
    assert_equal_forces(many.force, one.force, 1e-9)
    assert many.energy == pytest.approx(one.energy, rel=1e-9)


@settings(deadline=None, max_examples=15)
@given(laminate=laminates(), seed=SEEDS)
def test_the_response_turns_with_the_film(laminate: Laminate, seed: int) -> None:
    """Objectivity: a deformed film turned as a whole has the same energy and turned forces."""
    body = built(films.arched((2, 2)), laminate)
    u, activation = state(body, seed)
    net, turn = body.patch.control_points.reshape(-1, 3), films.rotation(seed)
    turned = (net + u.reshape(-1, 3)) @ turn.T - net
    one, two = body.respond(u, activation), body.respond(turned.ravel(), activation)
    # strains of 5 per cent from positions rounded to 1e-15, through exponents near 30
    assert_equal_forces(two.force.reshape(-1, 3), one.force.reshape(-1, 3) @ turn.T, 1e-11)
    assert two.energy == pytest.approx(one.energy, rel=1e-11)


@settings(deadline=None, max_examples=15)
@given(laminate=laminates(), seed=SEEDS)
def test_the_tangent_is_the_derivative_of_the_force_and_symmetric(
    laminate: Laminate, seed: int
) -> None:
    body = built(films.arched((2, 2)), laminate)
    u, activation = state(body, seed)
    a, b = np.random.default_rng(seed).normal(size=(2, body.size))
    step = 1e-7

    def along(d: Array) -> Array:
        ahead, behind = (body.respond(u + s * d, activation).force for s in (step, -step))
        return (ahead - behind) / (2 * step)

    tangent = body.tangent(body.respond(u, activation)).dense()
    # differences over 2e-7: round-off 1e-9 of the stiffest direction, which these contain
    assert_equal_forces(along(a), tangent @ a, 1e-6)
    sizes = np.linalg.norm(a) * np.linalg.norm(tangent @ b)
    assert abs(b @ along(a) - a @ along(b)) < 1e-6 * sizes


@settings(deadline=None, max_examples=15)
@given(laminate=laminates(), seed=SEEDS)
def test_a_film_upside_down_responds_in_the_mirror(laminate: Laminate, seed: int) -> None:
    upright = built(SMALL, laminate)
    reversed_one = built(SMALL, Laminate(laminate.layers[::-1]))
    u, activation = state(upright, seed)
    mirror = np.tile([1.0, 1.0, -1.0], SMALL.size)
    one, two = upright.respond(u, activation), reversed_one.respond(mirror * u, activation)
    # the same numbers with other signs, summed layer by layer in the other order
    assert_equal_forces(two.force, mirror * one.force, 1e-12)


@settings(deadline=None, max_examples=15)
@given(laminate=laminates(), seed=SEEDS)
def test_a_square_film_mirrored_at_its_diagonal_has_its_fibres_mirrored(
    laminate: Laminate, seed: int
) -> None:
    """X and Y exchanged."""
    mirrored = Laminate(
        tuple(
            Layer(one.name, one.material, one.thickness, 90.0 - one.fibre_angle, one.activity)
            for one in laminate.layers
        )
    )
    one, two = built(SQUARE, laminate), built(SQUARE, mirrored)
    u, activation = state(one, seed)

    def swap(field: Array) -> Array:
        exchanged = field.reshape(SQUARE.control_points.shape).transpose(1, 0, 2)
        return np.array(exchanged[..., [1, 0, 2]]).ravel()

    grid = int(np.sqrt(activation.size))
    turned = activation.reshape(grid, grid).T.ravel()
    found, expected = two.respond(swap(u), turned).force, one.respond(u, activation).force
    # sums over elements in another order
    assert_equal_forces(found, swap(expected), 1e-11)


@settings(deadline=None, max_examples=15)
@given(first=ANGLE, second=ANGLE, seed=SEEDS)
@pytest.mark.parametrize("name", ISOTROPIC)
def test_fibres_of_a_passive_isotropic_layer_do_not_matter(
    name: str, first: float, second: float, seed: int
) -> None:
    one, two = (
        built(films.arched((2, 2)), Laminate((Layer("film", name, 0.02, angle, 0.0),)))
        for angle in (first, second)
    )
    u, activation = state(one, seed)
    np.testing.assert_array_equal(
        one.respond(u, activation).force, two.respond(u, activation).force
    )


LAY_UPS: dict[str, tuple[tuple[Any, ...], ...]] = {
    "muscle on both sides": (
        ("muscle", "neo-hookean-fibre", 0.004, 30.0, 1.0),
        ("film", "mooney-rivlin", 0.016, 0.0, 0.0),
        ("skin", "neo-hookean-fibre", 0.003, -60.0, 0.5),
    ),
    "heart on metal": (
        ("film", "st-venant-kirchhoff", 0.018, 0.0, 0.0),
        ("heart", "holzapfel-ogden", 0.004, 20.0, 1.0),
    ),
}


@pytest.mark.parametrize("tension", tensions.NAMES)
@pytest.mark.parametrize("name", LAY_UPS)
def test_a_film_upside_down_bends_down_as_the_other_bends_up(name: str, tension: str) -> None:
    """Whole equilibria under the same activation, clamped at one end."""
    patch = films.flat((6, 3))
    layers = tuple(Layer(*fields) for fields in LAY_UPS[name])
    shapes = []
    for lay_up in (layers, layers[::-1]):
        body = built(patch, Laminate(lay_up), tensions.example(tension))
        held = films.clamped(body)
        target = held.under(np.full(body.points, 4.0))
        *_, last = LoadPath(held, target, 6, films.controls(body), 4).follow()
        shapes.append(last.state.displacement.reshape(-1, 3))
    mirrored = shapes[1] * [1.0, 1.0, -1.0]
    size = np.abs(shapes[0][:, 2]).max()
    assert size > 0.02  # it does bend
    # Newton's tolerance: 1e-7 of the film's diagonal of 4 mm, squared by its last step
    assert np.abs(shapes[0] - mirrored).max() < 1e-8 * size
