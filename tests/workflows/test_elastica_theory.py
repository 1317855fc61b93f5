"""Bent cantilevers: tabulated elastica, small loads, and a twin that minimises the shell's energy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from workflows.theory.elastica import Strip, rolled, rolled_shell, sheared, sheared_shell

SHEARED = Strip(length=10.0, width=1.0, thickness=0.1, modulus=1.2e6)
ROLLED = Strip(length=12.0, width=1.0, thickness=0.1, modulus=1.2e6)


@pytest.mark.parametrize(
    ("load", "rise", "shortening"),
    [
        (1.0, 0.30172, 0.05643),
        (2.0, 0.49346, 0.16064),
        (5.0, 0.71379, 0.38763),
        (10.0, 0.81061, 0.55500),
    ],
)
def test_the_sheared_elastica_has_the_tabulated_tip(
    load: float, rise: float, shortening: float
) -> None:
    """Mattiasson (1981), Table 1, as other projects' test suites quote it."""
    tip = sheared(Strip(1.0, 1.0, 1.0, 12.0), load)
    # five digits are printed
    assert tip.deflection == pytest.approx(rise, abs=5.1e-6)
    assert tip.shortening == pytest.approx(shortening, abs=5.1e-6)


def test_small_loads_give_the_linear_beam() -> None:
    ei, length = SHEARED.bending_stiffness, SHEARED.length
    force, moment = 1e-3, 1e-3
    # the next term is of relative size (P L^2/EI)^2/10 = 1e-7, and the shell stretches by (t/R)^2
    for solve in (sheared, sheared_shell):
        expected = force * length**3 / (3 * ei)
        assert solve(SHEARED, force).deflection == pytest.approx(expected, rel=1e-6)
    for solve in (rolled, rolled_shell):
        expected = moment * length**2 / (2 * ei)
        assert solve(SHEARED, moment).deflection == pytest.approx(expected, rel=1e-6)
    assert sheared(SHEARED, 0.0).deflection == rolled(SHEARED, 0.0).deflection == 0.0


@pytest.mark.parametrize("thickness", [0.1, 0.01])
def test_a_thin_shell_tends_to_the_elastica_as_its_thickness_squared(thickness: float) -> None:
    modulus = 100.0 * 12.0 / thickness**3  # EI = 100 at any thickness
    strip = Strip(10.0, 1.0, thickness, modulus)
    shear = sheared_shell(strip, 4.0).deflection / sheared(strip, 4.0).deflection - 1.0
    roll = rolled_shell(strip, 20.0).rotation / rolled(strip, 20.0).rotation - 1.0
    # measured 0.0037 t^2 and, at R = 5, t^2/(6 R^2) = 0.0067 t^2; rounding of the solver below 1e-10
    assert 0.003 * thickness**2 < shear < 0.005 * thickness**2
    assert roll == pytest.approx(thickness**2 / (6 * 25), rel=0.01)


def test_the_shell_has_least_energy() -> None:
    """A twin: the rod's energy on straight pieces, minimised without any balance of forces."""
    strip, force, pieces = Strip(10.0, 1.0, 0.1, 1.2e6), 4.0, 40
    step = strip.length / pieces
    ea, ei = strip.axial_stiffness, strip.bending_stiffness

    def energy(unknown: np.ndarray) -> float:
        theta, stretch = np.concatenate(([0.0], unknown[:pieces])), 1 + 1e-3 * unknown[pieces:]
        middle, turn = 0.5 * (theta[1:] + theta[:-1]), np.diff(theta) / step
        inner = 0.5 * ea * (0.5 * (stretch**2 - 1)) ** 2 + 0.5 * ei * (stretch * turn) ** 2
        return float(step * inner.sum() - force * step * (stretch * np.sin(middle)).sum())

    exact = sheared_shell(strip, force)
    found = minimize(energy, np.zeros(2 * pieces), method="L-BFGS-B", options={"maxfun": 10**6})
    # second order in the pieces: (L/40)^2 theta'^2/24 is 1e-4
    assert found.x[pieces - 1] == pytest.approx(exact.rotation, rel=1e-3)


def test_a_moment_beyond_the_section_is_refused() -> None:
    thick = Strip(1.0, 1.0, 1.0, 12.0)
    with pytest.raises(ValueError, match=r"carries at most 0\.942"):
        rolled_shell(thick, 0.95)
    assert rolled_shell(thick, 0.94).rotation > 0
