"""Material files: laws from their energies, moduli at rest, closed forms, refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from stages.mechanics.config import AnyMaterial
from stages.mechanics.materials.base import Material, PlaneStress, law_of
from stages.mechanics.materials.st_venant_kirchhoff import StVenantKirchhoff
from stages.mechanics.shell.plane_stress import plane_law, thickness_stretch
from tests.mechanics import materials, points
from tests.mechanics.materials import EXAMPLES, example

EVERY = materials.every()
INCOMPRESSIBLE = [name for name, one in EVERY.items() if not isinstance(one, PlaneStress)]
INDEX = {(0, 0): 0, (0, 1): 1, (0, 2): 2, (1, 1): 3, (1, 2): 4, (2, 2): 5}
ADAPTER: TypeAdapter[Material] = TypeAdapter(AnyMaterial)


@pytest.fixture(params=EVERY, scope="module")
def material(request: pytest.FixtureRequest) -> Material:
    """Every material file of the project, and two laws that mix all arguments."""
    return EVERY[request.param]


def check_derivatives(value: Any, gradient: Any, hessian: Any, at: np.ndarray) -> None:
    step = 1e-4
    for i, unit in enumerate(np.eye(3) * step):

        def slope(f: Any, unit: np.ndarray = unit) -> np.ndarray:
            near = np.array(f(at + unit)) - np.array(f(at - unit))
            far = np.array(f(at + 2 * unit)) - np.array(f(at - 2 * unit))
            return (8 * near - far) / (12 * step)

        # fourth order over 1e-4: round-off of energies and slopes near 1e2 kPa
        assert gradient(at)[i] == pytest.approx(slope(value), rel=1e-8, abs=1e-9)
        bend = slope(gradient)
        for j in range(3):
            expected = hessian(at)[INDEX[min(i, j), max(i, j)]]
            assert expected == pytest.approx(bend[j], rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("at", [(0.4, 0.3, 0.21), (0.05, 0.06, -0.1)])
def test_laws_are_consistent_with_their_own_energy(at: Any, material: Material) -> None:
    law, p = law_of(type(material)), material.constants()
    check_derivatives(
        lambda x: law.energy(*x, p),
        lambda x: law.gradient(*x, p),
        lambda x: law.hessian(*x, p),
        np.array(at),
    )


@pytest.mark.parametrize("at", [(0.3, -0.1, 0.21), (-0.2, 0.03, -0.1)])
def test_plane_laws_are_consistent_with_their_own_energy(at: Any, material: Material) -> None:
    law, p = plane_law(type(material)), material.constants()
    check_derivatives(*(lambda x, k=k: law(*x, p)[k] for k in range(3)), np.array(at))


@pytest.mark.parametrize("material", INCOMPRESSIBLE, indirect=True)
@pytest.mark.parametrize("at", [(0.3, -0.1, 0.21), (-0.2, 0.03, -0.1)])
def test_the_thickness_is_eliminated_at_constant_volume(at: Any, material: Material) -> None:
    """w(trace, det, fibre) = psi(t + 1/j, t/j + j, fibre + 1)."""
    law, p = law_of(type(material)), material.constants()
    trace, det, fibre = at
    t, j = 2.0 + trace, 1.0 + trace + det
    expected = law.energy(t + 1.0 / j - 3.0, t / j + j - 3.0, fibre, p)
    # the same number, with differences of numbers near three
    assert plane_law(type(material))(*at, p)[0] == pytest.approx(expected, rel=1e-13)


MODULI = {
    # incompressible: E = 3 mu and nu = 1/2, so E/(1 - nu^2) = 4 mu
    "neo-hookean": (4 * 500.0, 2 * 500.0, 500.0),
    "mooney-rivlin": (8 * 250.0, 4 * 250.0, 2 * 250.0),  # mu = 2 (c_1 + c_2)
    "neo-hookean-fibre": (4 * 0.767 + 21.0, 2 * 0.767, 0.767),  # and E_p along the fibres
    "holzapfel-ogden": (4 * 0.059, 2 * 0.059, 0.059),  # and 4 a_f once they are stretched
    "st-venant-kirchhoff": (1500 / 0.91, 0.3 * 1500 / 0.91, 1500 / 2.6),
}


@pytest.mark.parametrize("name", materials.NAMES)
def test_the_tangent_at_rest_holds_the_moduli_of_linear_elasticity(name: str) -> None:
    """C_1111 = E/(1 - nu^2), C_1122 = nu C_1111, C_1212 = mu in plane stress."""
    c = points.tangent(points.at(example(name))((0.0, 0.0, 0.0)))
    along, across, shear = MODULI[name]
    # products of three numbers or so
    np.testing.assert_allclose(
        [c[0, 0], c[0, 1], c[2, 2], c[0, 2], c[1, 2]], [along, across, shear, 0, 0], rtol=1e-14
    )


def test_fibres_of_heart_muscle_stiffen_as_soon_as_they_are_stretched() -> None:
    """C_1111 jumps by 4 a_f at lambda_f = 1, from matrix alone to matrix and fibres."""
    heart = points.at(example("holzapfel-ogden"))
    slack, taut = (points.tangent(heart((e, 0.0, 0.0)))[0, 0] for e in (-1e-9, 1e-9))
    # exponents of 1e-8
    assert taut - slack == pytest.approx(4 * 18.472, rel=1e-6)


def uniaxial(name: str, l: float) -> float:  # noqa: E741
    """Cauchy stress of a bar, kPa, along its fibres where it has any; from textbooks."""
    shape = l**2 - 1 / l
    if name == "neo-hookean":
        return 500.0 * shape
    if name == "mooney-rivlin":
        return 2 * shape * (200.0 + 50.0 / l)
    if name == "neo-hookean-fibre":
        return 0.767 * shape + l * 21.0 / 5.5 * (math.exp(5.5 * (l - 1)) - 1)
    if name == "holzapfel-ogden":
        matrix = 0.059 * shape * math.exp(8.023 * (l**2 + 2 / l - 3))
        excess = max(l**2 - 1, 0.0)
        return matrix + 2 * l**2 * 18.472 * excess * math.exp(16.026 * excess**2)
    green = 0.5 * (l**2 - 1)  # st-venant-kirchhoff: S = E times it; sides 1 - 2 nu green, squared
    return 1500.0 * green * l / (1 - 0.6 * green)


@pytest.mark.parametrize("stretch", [0.75, 0.95, 1.0, 1.05, 1.2])
@pytest.mark.parametrize("name", materials.NAMES)
def test_uniaxial_tension_follows_the_closed_form(name: str, stretch: float) -> None:
    """Free sides contract alike in the plane and through the thickness; nothing else acts."""
    material, e1 = example(name), 0.5 * (stretch**2 - 1.0)
    side = 1.0 - 0.6 * e1 if name == "st-venant-kirchhoff" else 1.0 / stretch  # squared stretch
    _, s11, s22, s12, *moduli = points.at(material)((e1, 0.5 * (side - 1.0), 0.0))
    # Cauchy from S: l^2 S over the change of volume, l times side
    expected = uniaxial(name, stretch)
    assert stretch**2 * s11 / (stretch * side) == pytest.approx(expected, rel=1e-11, abs=1e-12)
    # round-off of stresses that cancel
    assert abs(s22) < 1e-13 * max(moduli)
    assert s12 == 0.0
    trace, det = 2 * e1 + side - 1.0, 2 * e1 * (side - 1.0)
    thickness = thickness_stretch(material, trace, det, 2 * e1)
    assert thickness == pytest.approx(math.sqrt(side), rel=1e-14)


@pytest.mark.parametrize("nu", [-0.4, 0.0, 0.3, 0.49])
def test_st_venant_kirchhoff_in_the_plane_is_the_solid_law_with_free_faces(nu: float) -> None:
    """S = lambda tr(E) I + 2 mu E in three dimensions, with E_33 such that S_33 = 0."""
    young = 1500.0
    lame, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    e = np.array([[0.08, 0.03, 0.0], [0.03, -0.05, 0.0], [0.0, 0.0, 0.0]])
    e[2, 2] = -lame / (lame + 2 * mu) * np.trace(e)
    s = lame * np.trace(e) * np.eye(3) + 2 * mu * e
    psi = 0.5 * lame * np.trace(e) ** 2 + mu * np.trace(e @ e)
    assert abs(s[2, 2]) < 1e-12
    solid = StVenantKirchhoff(density=1.0, young_modulus=young, poisson_ratio=nu)
    energy, s11, s22, s12, *_ = points.at(solid)((0.08, -0.05, 0.03))
    # lambda grows to 16 E at nu = 0.49: a few roundings of it
    np.testing.assert_allclose([s11, s22, s12], [s[0, 0], s[1, 1], s[0, 1]], rtol=1e-12)
    assert energy == pytest.approx(psi, rel=1e-12)
    trace, det = 2 * 0.03, 4 * (0.08 * -0.05 - 0.03**2)
    found = thickness_stretch(solid, trace, det, 0.16)
    assert found == pytest.approx(math.sqrt(1 + 2 * e[2, 2]), rel=1e-14)


def test_a_new_material_without_parameters_to_test_it_is_told_where_to_put_them() -> None:
    with pytest.raises(LookupError, match=r"material 'rubber' .* EXAMPLES in tests/mechanics"):
        example("rubber")


def test_an_unknown_material_is_refused_with_the_names_on_offer() -> None:
    with pytest.raises(ValidationError, match=", ".join(materials.NAMES)):
        ADAPTER.validate_python({"name": "rubber"})


@pytest.mark.parametrize(
    ("name", "field", "value"),
    [
        ("neo-hookean", "shear_modulus", 0.0),
        ("neo-hookean-fibre", "fibre_exponent", 0.0),
        ("mooney-rivlin", "c_1", 0.0),
        ("mooney-rivlin", "c_2", -1.0),
        ("holzapfel-ogden", "matrix_stiffness", -0.1),
        ("holzapfel-ogden", "fibre_exponent", 0.0),
        ("st-venant-kirchhoff", "young_modulus", 0.0),
        ("st-venant-kirchhoff", "poisson_ratio", 0.5),
        ("st-venant-kirchhoff", "poisson_ratio", -1.0),
        ("st-venant-kirchhoff", "density", 0.0),
    ],
)
def test_parameters_without_meaning_are_refused_by_name(
    name: str, field: str, value: float
) -> None:
    given = dict(EXAMPLES[name]) | {field: value}
    with pytest.raises(ValidationError, match=field):
        ADAPTER.validate_python(given)
