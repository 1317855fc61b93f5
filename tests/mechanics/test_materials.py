"""Materials and the material point: derivatives by differences, objectivity, closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from stages.mechanics.config import AnyMaterial
from stages.mechanics.material_point import PlaneReference, compile_point, constants_of
from stages.mechanics.materials.base import Material, law_of
from stages.mechanics.plane_stress import plane_gradient, plane_hessian
from stages.mechanics.tension_laws.prescribed import Prescribed
from tests.mechanics import materials, tensions
from tests.mechanics.films import MUSCLE, PDMS
from tests.mechanics.materials import example

PRESCRIBED = Prescribed()


def passive(material: Material) -> tuple[Any, ...]:
    """What a compiled point takes as constants."""
    return constants_of(material, PRESCRIBED)


@pytest.fixture(params=[*materials.NAMES, "mixed"], scope="module")
def material(request: pytest.FixtureRequest) -> Material:
    """Every material file of the project, and a law that mixes all invariants."""
    return materials.Mixed(density=1.0) if request.param == "mixed" else example(request.param)


def skew_reference() -> PlaneReference:
    """A reference metric that is neither unit nor diagonal, with a unit fibre vector."""
    metric = np.array([[2.0, 0.3], [0.3, 1.5]])
    con = np.linalg.inv(metric)
    f = np.array([0.6, 0.2])
    f = f / np.sqrt(f @ metric @ f)
    return PlaneReference(
        con[0, 0],
        con[1, 1],
        con[0, 1],
        1.0 / np.linalg.det(metric),
        f[0] ** 2,
        f[1] ** 2,
        f[0] * f[1],
    )


STRAINS = [(0.0, 0.0, 0.0), (0.1, 0.2, -0.05), (-0.2, 0.3, 0.15), (1.5, -0.3, 0.1)]
HALF_SHEAR = np.array([1.0, 1.0, 0.5])
"""S^12 belongs to E_12 + E_21: a difference by E_12 alone sees it twice."""


def differences(respond: Any, strain: Any, activation: float, constants: Any) -> np.ndarray:
    """Derivatives of the whole response by E_11, E_22, E_12 (shape (3, response))."""
    step = 1e-6
    rows = []
    for i in range(3):
        ahead, behind = np.array(strain, float), np.array(strain, float)
        ahead[i] += step
        behind[i] -= step
        values = [
            np.array(respond(*e, skew_reference(), activation, constants)) for e in (ahead, behind)
        ]
        rows.append((values[0] - values[1]) / (2 * step))
    return np.array(rows) * HALF_SHEAR[:, None]


@pytest.mark.parametrize("strain", STRAINS)
def test_passive_stress_is_the_derivative_of_the_energy(strain: Any, material: Material) -> None:
    """S = 2 dpsi/dC = dpsi/dE."""
    respond = compile_point(material, PRESCRIBED)
    point = respond(*strain, skew_reference(), 0.0, passive(material))
    slopes = differences(respond, strain, 0.0, passive(material))[:, 0]
    # differences over 2e-6 of an energy of up to 1e3 kPa: about 1e-7 kPa
    np.testing.assert_allclose([point.s11, point.s22, point.s12], slopes, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("tension", tensions.NAMES)
@pytest.mark.parametrize("strain", STRAINS)
def test_the_tangent_is_the_derivative_of_the_stress(
    strain: Any, material: Material, tension: str
) -> None:
    """C = 2 dS/dC = dS/dE, active part and its stretch derivative included (eq. 51)."""
    law = tensions.example(tension)
    respond, constants = compile_point(material, law), constants_of(material, law)
    c = respond(*strain, skew_reference(), 15.0, constants)
    slopes = differences(respond, strain, 15.0, constants)[:, 1:4]
    tangent = [
        [c.c1111, c.c1122, c.c1112],
        [c.c1122, c.c2222, c.c2212],
        [c.c1112, c.c2212, c.c1212],
    ]
    # as above; the largest moduli are some 1e3 kPa
    np.testing.assert_allclose(tangent, slopes, rtol=1e-6, atol=2e-6)


def test_laws_are_consistent_with_their_own_energy(material: Material) -> None:
    law = law_of(type(material))
    p, at, step = material.constants(), np.array([3.4, 3.3, 1.21]), 1e-5
    index = {(0, 0): 0, (0, 1): 1, (0, 2): 2, (1, 1): 3, (1, 2): 4, (2, 2): 5}
    for i in range(3):
        ahead, behind = at.copy(), at.copy()
        ahead[i] += step
        behind[i] -= step
        slope = (law.energy(*ahead, p) - law.energy(*behind, p)) / (2 * step)
        # differences over 2e-5 of an energy of 1e2 kPa: 1e-9 kPa
        assert law.gradient(*at, p)[i] == pytest.approx(slope, rel=1e-7, abs=1e-8)
        bend = (np.array(law.gradient(*ahead, p)) - np.array(law.gradient(*behind, p))) / (2 * step)
        for j in range(3):
            expected = law.hessian(*at, p)[index[min(i, j), max(i, j)]]
            assert expected == pytest.approx(bend[j], rel=1e-7, abs=1e-8)


def test_rest_is_free_of_stress_and_of_energy(material: Material) -> None:
    law, p = law_of(type(material)), material.constants()
    assert law.energy(3.0, 3.0, 1.0, p) == 0.0
    assert law.gradient(3.0, 3.0, 1.0, p)[2] == 0.0  # incompressibility takes care of the others
    respond = compile_point(material, PRESCRIBED)
    point = respond(0.0, 0.0, 0.0, skew_reference(), 0.0, passive(material))
    assert (point.s11, point.s22, point.s12) == (0.0, 0.0, 0.0)


def test_a_new_material_without_parameters_to_test_it_is_told_where_to_put_them() -> None:
    with pytest.raises(LookupError, match=r"material 'rubber' .* EXAMPLES in tests/mechanics"):
        example("rubber")


def test_the_elimination_of_the_thickness_is_a_chain_rule() -> None:
    """w(t, j, q) = psi(t + 1/j, t/j + j, q), for an energy that mixes all three invariants."""

    def psi(x: np.ndarray) -> float:
        a, b, c = x
        return float(2 * a + 3 * b + a * b + 0.5 * a * a * c + b * b + b * c + c**3)

    def gradient(x: np.ndarray) -> tuple[float, float, float]:
        a, b, c = x
        return 2 + b + a * c, 3 + a + 2 * b + c, 0.5 * a * a + b + 3 * c * c

    def w(y: np.ndarray) -> float:
        t, j, q = y
        return psi(np.array([t + 1 / j, t / j + j, q]))

    y = np.array([2.3, 1.2, 1.1])
    x = np.array([y[0] + 1 / y[1], y[0] / y[1] + y[1], y[2]])
    slopes = gradient(x)
    first = plane_gradient(y[0], y[1], *slopes)
    second = plane_hessian(y[0], y[1], slopes, (y[2], 1.0, x[0], 2.0, 1.0, 6 * y[2]))
    step = 1e-4
    unit = np.eye(3) * step
    entry = {(0, 0): 0, (0, 1): 1, (0, 2): 2, (1, 1): 3, (1, 2): 4, (2, 2): 5}
    for i in range(3):
        # central differences over 1e-4: truncation and round-off near 1e-7
        assert first[i] == pytest.approx((w(y + unit[i]) - w(y - unit[i])) / (2 * step), rel=1e-6)
        for j in range(i, 3):
            mixed = (
                w(y + unit[i] + unit[j])
                - w(y + unit[i] - unit[j])
                - w(y - unit[i] + unit[j])
                + w(y - unit[i] - unit[j])
            ) / (4 * step**2)
            assert second[entry[i, j]] == pytest.approx(mixed, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("stretch", [0.6, 0.95, 1.3, 2.5])
def test_uniaxial_tension_of_the_neo_hookean_solid(stretch: float) -> None:
    """Free sides contract by l^(-1/2); sigma = mu (l^2 - 1/l), so S = mu (1 - l^-3); nothing else."""
    respond = compile_point(PDMS, PRESCRIBED)
    unit = PlaneReference(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    e1, e2 = 0.5 * (stretch**2 - 1.0), 0.5 * (1.0 / stretch - 1.0)
    point = respond(e1, e2, 0.0, unit, 0.0, passive(PDMS))
    # exact formulas: round-off of a few kPa * 1e-16 only
    assert stretch**2 * point.s11 == pytest.approx(500.0 * (stretch**2 - 1 / stretch), rel=1e-12)
    assert abs(point.s22) < 1e-10
    assert point.s12 == 0.0


def test_stress_does_not_depend_on_the_coordinates(material: Material) -> None:
    """Other in-plane coordinates of the same strain give the same tensor S and the same energy."""
    respond = compile_point(material, PRESCRIBED)
    strain = np.array([[0.2, 0.05], [0.05, -0.1]])
    fibre = np.array([math.cos(0.7), math.sin(0.7)])
    base = np.array([[1.3, 0.2], [-0.4, 0.9]])  # rows: covariant vectors G_a in Cartesian axes
    tensors = []
    for g in (np.eye(2), base):
        metric = g @ g.T
        con = np.linalg.inv(metric)
        f = con @ (g @ fibre)
        e = g @ strain @ g.T
        reference = PlaneReference(
            con[0, 0],
            con[1, 1],
            con[0, 1],
            1 / np.linalg.det(metric),
            f[0] ** 2,
            f[1] ** 2,
            f[0] * f[1],
        )
        point = respond(e[0, 0], e[1, 1], e[0, 1], reference, 9.0, passive(material))
        s = np.array([[point.s11, point.s12], [point.s12, point.s22]])
        tensors.append((g.T @ s @ g, point.energy))
    # the same sums in other coordinates: round-off
    np.testing.assert_allclose(tensors[0][0], tensors[1][0], rtol=1e-11, atol=1e-11)
    assert tensors[0][1] == pytest.approx(tensors[1][1], rel=1e-12)


def test_the_active_stress_pulls_along_the_fibres_with_the_given_cauchy_stress() -> None:
    """S_a = sigma_a/l^2 f0 (x) f0: at stretch l along f0, l^2 S_a = sigma_a (eqs. 37-39)."""
    unit = PlaneReference(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    respond = compile_point(MUSCLE, PRESCRIBED)
    e1 = 0.5 * (1.1**2 - 1.0)
    with_stress = respond(e1, 0.0, 0.0, unit, 12.2, passive(MUSCLE))
    without = respond(e1, 0.0, 0.0, unit, 0.0, passive(MUSCLE))
    assert 1.1**2 * (with_stress.s11 - without.s11) == pytest.approx(12.2, rel=1e-12)
    assert with_stress.s22 == without.s22


def test_a_turned_over_element_gives_nan_and_not_a_number_to_trust() -> None:
    unit = PlaneReference(1.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0)
    point = compile_point(PDMS, PRESCRIBED)(-0.6, 0.1, 0.0, unit, 0.0, passive(PDMS))
    assert math.isnan(point.s11)


def test_an_unknown_material_is_refused_with_the_names_on_offer() -> None:
    with pytest.raises(ValidationError, match=", ".join(materials.NAMES)):
        TypeAdapter(AnyMaterial).validate_python({"name": "rubber"})


def test_a_material_without_stiffness_is_refused() -> None:
    with pytest.raises(ValidationError, match="shear_modulus"):
        TypeAdapter(AnyMaterial).validate_python(
            {"name": "neo-hookean", "density": 0.965, "shear_modulus": 0.0}
        )
