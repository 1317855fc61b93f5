"""Tension laws: slopes, the numbers of eq. 96, both sides of its ends, and the shell's tangent."""

from __future__ import annotations

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from stages.mechanics.config import AnyTensionLaw
from stages.mechanics.shell.shell import build_shell
from stages.mechanics.tension_laws.base import TensionLaw, functions_of
from stages.mechanics.tension_laws.length_dependent import LengthDependent
from tests.mechanics import films, tensions, twin

ADAPTER: TypeAdapter[TensionLaw] = TypeAdapter(AnyTensionLaw)
TABLE_2 = {"optimal_stretch": 1.24, "min_stretch": 0.86, "max_stretch": 1.34, "prestretch": 1.14}
INSIDE = [0.87, 0.95, 1.0, 1.1, 1.33]


def pull(law: TensionLaw, activation: float, stretch: float) -> tuple[float, float]:
    return functions_of(type(law)).tension(activation, stretch, law.constants())


def imposed(**changes: float) -> LengthDependent:
    return LengthDependent(**{**TABLE_2, **changes})


@pytest.mark.parametrize("stretch", [0.5, *INSIDE, 1.6])
@pytest.mark.parametrize("name", tensions.NAMES)
def test_the_slope_is_the_derivative_of_the_stress(name: str, stretch: float) -> None:
    law, step = tensions.example(name), 1e-6
    ahead, behind = (pull(law, 15.0, stretch + s)[0] for s in (step, -step))
    # central differences of stresses of 15 kPa over 2e-6
    assert pull(law, 15.0, stretch)[1] == pytest.approx((ahead - behind) / (2 * step), abs=1e-7)


def test_the_imposed_law_has_the_values_of_the_paper() -> None:
    """Largest at lambda_0 - (lambda_s - 1) = 1.10; in the flat film 1 - (0.10/0.24)^2 of it."""
    # decimal fractions such as 1.24 - 0.14 are rounded in the last digit
    assert pull(imposed(), 21.6, 1.10)[0] == pytest.approx(21.6, rel=1e-15)
    assert pull(imposed(), 21.6, 1.0)[0] == pytest.approx(21.6 * 119 / 144, rel=1e-14)
    assert pull(imposed(prestretch=1.24), 21.6, 1.0)[0] == pytest.approx(21.6, rel=1e-15)


@pytest.mark.parametrize("edge", [0.86, 1.34])
def test_with_the_papers_numbers_only_the_slope_jumps_at_the_ends(edge: float) -> None:
    """The zeros of the parabola, 1.10 -+ 0.24, are the ends of the range of Table 2."""
    inward = 1.0 if edge < 1.0 else -1.0
    near, slope = pull(imposed(), 10.0, edge + inward * 1e-9)
    assert abs(near) < 1e-6  # 1e-9 from a zero, slope 83 kPa
    assert slope == pytest.approx(inward * 2 * 10.0 / 0.24, rel=1e-6)
    assert pull(imposed(), 10.0, edge - inward * 1e-9) == (0.0, 0.0)


def test_with_other_numbers_the_stress_jumps_from_its_value_to_zero() -> None:
    law = imposed(min_stretch=0.95)
    inside, slope = pull(law, 10.0, 0.95)
    assert inside == pytest.approx(10.0 * (1 - (0.15 / 0.24) ** 2), rel=1e-14)
    assert slope > 0
    assert pull(law, 10.0, np.nextafter(0.95, 0.0)) == (0.0, 0.0)


@pytest.mark.parametrize("name", tensions.NAMES)
def test_the_shell_takes_the_law_and_its_slope(name: str) -> None:
    """The compiled film equals its plain twin, whose tangent is derived apart."""
    body = build_shell(
        films.arched((2, 2)), films.two_layers(), films.MATERIALS, tension=tensions.example(name)
    )
    state, activation = films.random_state(body, seed=11)
    response = body.respond(state, activation)
    force, matrix, _ = twin.respond(body, state, activation)
    # the same sums in another order
    assert np.abs(response.force - force).max() < 1e-12 * np.abs(force).max()
    difference = np.abs(body.tangent(response).dense() - matrix).max()
    assert difference < 1e-12 * np.abs(matrix).max()


def test_a_passive_layer_does_not_pull_and_a_half_active_one_pulls_half() -> None:
    patch, law = films.flat((2, 2)), imposed()
    rest, activation = np.zeros(3 * films.flat((2, 2)).size), np.full(36, 10.0)

    def moments(activity: float) -> np.ndarray:
        bottom, top = films.two_layers().layers
        lay_up = type(films.two_layers())(
            (bottom, type(top)(**{**vars(top), "activity": activity}))
        )
        body = build_shell(patch, lay_up, films.MATERIALS, tension=law)
        return body.respond(rest, activation).resultants.moment

    assert not moments(0.0).any()
    # one product more
    np.testing.assert_allclose(2 * moments(0.5), moments(1.0), rtol=1e-14)


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"optimal_stretch": 1.0}, "must differ from 1"),
        ({"min_stretch": 1.4}, "min_stretch = 1.4 must lie below max_stretch = 1.34"),
        ({"prestretch": 0.0}, "prestretch"),
    ],
)
def test_parameters_without_meaning_are_refused(changes: dict[str, float], problem: str) -> None:
    with pytest.raises(ValidationError, match=problem):
        ADAPTER.validate_python({"name": "length-dependent", **TABLE_2, **changes})


def test_an_unknown_law_is_refused_with_the_names_on_offer() -> None:
    with pytest.raises(ValidationError, match="length-dependent, prescribed"):
        ADAPTER.validate_python("hill")
