"""Any material with any tension law: derivatives, coordinates, small strains; at random points."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from stages.mechanics.materials.base import Material
from stages.mechanics.tension_laws.base import TensionLaw
from tests.mechanics import materials, points, tensions
from tests.mechanics.points import Point

MATERIALS = materials.every()
ACTIVATION = st.floats(0.0, 30.0)


@pytest.fixture(params=MATERIALS, scope="module")
def material(request: pytest.FixtureRequest) -> Material:
    """Every material file of the project, and two laws that mix all arguments."""
    return MATERIALS[request.param]


@pytest.fixture(params=tensions.NAMES, scope="module")
def tension(request: pytest.FixtureRequest) -> TensionLaw:
    """Every tension law of the project."""
    return tensions.example(request.param)


def away_from_kinks(point: Point) -> None:
    """Laws bend where fibres slacken and at the ends of the range of eq. 96: no derivative there."""
    for bend in (1.0, 0.86, 1.34):
        assume(abs(point.stretch - bend) > 1e-3)


@given(point=points.points())
def test_passive_stress_is_the_derivative_of_the_energy(material: Material, point: Point) -> None:
    """S = 2 dpsi/dC = dpsi/dE."""
    away_from_kinks(point)
    evaluate = points.at(material)
    here = evaluate(point.covariant, point.reference)
    slopes = points.differences(lambda e: evaluate(e, point.reference), point.covariant)[:, 0]
    # fourth order over 1e-5 leaves round-off, 1e-16/1e-5 of an energy near a modulus times strain
    scale = np.abs(points.tangent(here)).max()
    np.testing.assert_allclose(here[1:4], slopes, rtol=0, atol=1e-9 * scale)


@given(point=points.points(), activation=ACTIVATION)
def test_the_tangent_is_the_derivative_of_the_stress_and_symmetric(
    material: Material, tension: TensionLaw, point: Point, activation: float
) -> None:
    """C = 2 dS/dC = dS/dE with the active part and its stretch derivative (eq. 51)."""
    away_from_kinks(point)
    evaluate = points.at(material, tension, activation)
    here = evaluate(point.covariant, point.reference)
    slopes = points.differences(lambda e: evaluate(e, point.reference), point.covariant)[:, 1:4]
    # as above; coordinates down to half a unit make moduli up to sixteen times as large
    scale = np.abs(points.tangent(here)).max() + activation
    np.testing.assert_allclose(points.tangent(here), slopes, rtol=0, atol=1e-8 * scale)
    np.testing.assert_allclose(slopes, slopes.T, rtol=0, atol=1e-8 * scale)


@given(point=points.points(), activation=ACTIVATION)
def test_stress_and_energy_do_not_depend_on_the_coordinates(
    material: Material, tension: TensionLaw, point: Point, activation: float
) -> None:
    """Other in-plane coordinates of the same strain give the same tensor S and the same energy."""
    # the end of a range is hit with one rounding and missed with another
    away_from_kinks(point)
    evaluate = points.at(material, tension, activation)
    found = []
    for place in (point, point._replace(base=np.eye(2))):
        energy, s11, s22, s12, *moduli = evaluate(place.covariant, place.reference)
        found.append(np.array([energy, *_cartesian(place.base, s11, s22, s12)]))
    # the same sums in other coordinates: round-off of moduli times strains
    scale = np.abs(moduli).max() + activation
    np.testing.assert_allclose(found[0], found[1], rtol=0, atol=1e-12 * scale)


def _cartesian(base: Any, s11: float, s22: float, s12: float) -> Any:
    return (base.T @ np.array([[s11, s12], [s12, s22]]) @ base).ravel()


@given(point=points.points(), angle=st.floats(0.0, math.pi))
def test_a_turned_sheet_with_turned_fibres_responds_as_before(
    material: Material, tension: TensionLaw, point: Point, angle: float
) -> None:
    """Isotropy about the fibres: strain and fibres turned by an angle turn the stress."""
    away_from_kinks(point)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    turned = Point(np.eye(2), turn @ point.fibre, turn @ point.strain @ turn.T)
    straight = point._replace(base=np.eye(2))
    evaluate = points.at(material, tension, 9.0)
    one, two = (evaluate(place.covariant, place.reference) for place in (straight, turned))
    expected = turn @ _cartesian(np.eye(2), *one[1:4]).reshape(2, 2) @ turn.T
    scale = np.abs(one[4:]).max() + 9.0  # as above
    np.testing.assert_allclose(
        _cartesian(np.eye(2), *two[1:4]), expected.ravel(), rtol=0, atol=1e-12 * scale
    )


@settings(max_examples=30)
@given(point=points.points())
def test_no_digits_are_lost_at_small_strains(material: Material, point: Point) -> None:
    """At strains of 1e-11 the stress is tangent times strain but for terms of their size."""
    assume(abs(point.stretch - 1.0) > 1e-3)
    strain = 5e-11 * point.covariant
    here = points.at(material)(strain, point.reference)
    linear = points.tangent(here) @ (strain * [1, 1, 2])
    # quadratic terms: 1e-11 times exponents near 30; round-off is far below. Written in C instead
    # of E, digits of 1e-16 in 1 + 1e-11 would show here as 1e-5
    scale = np.abs(points.tangent(here)).max() * np.abs(strain).max()
    np.testing.assert_allclose(here[1:4], linear, rtol=0, atol=1e-8 * scale)


def test_rest_is_free_of_stress_and_of_energy_exactly(
    material: Material, tension: TensionLaw
) -> None:
    skew = Point(np.array([[1.4, 0.2], [0.3, 0.8]]), np.array([0.6, 0.8]), np.zeros((2, 2)))
    assert not points.at(material, tension)(skew.covariant, skew.reference)[:4].any()


def test_the_active_stress_pulls_along_the_fibres_with_the_given_cauchy_stress(
    material: Material,
) -> None:
    """S_a = sigma_a/l^2 f0 (x) f0: at stretch l along f0, l^2 S_a = sigma_a (eqs. 37-39)."""
    strain = (0.5 * (1.1**2 - 1.0), 0.0, 0.0)
    pulled, slack = points.at(material, activation=12.2)(strain), points.at(material)(strain)
    # a difference of stresses near 1e3 kPa
    assert 1.1**2 * (pulled[1] - slack[1]) == pytest.approx(12.2, abs=1e-11)
    assert pulled[2] == slack[2]


def test_a_turned_over_element_gives_nan_and_not_a_number_to_trust(material: Material) -> None:
    assert np.isnan(points.at(material)((0.1, -0.6, 0.0))[1:4]).all()
