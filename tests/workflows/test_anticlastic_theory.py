"""Films of finite width: limits, and the classical bent plate under a thin active layer."""

from __future__ import annotations

import numpy as np
import pytest

from workflows.theory.anticlastic import film_of_width
from workflows.theory.bilayer import Ply, cylindrical, free_strip, prescribed

FILM = [Ply(0.018, 500.0), Ply(0.004, 0.767, 21.0, 5.5, prescribed(12.2))]


def edge_width(curvature: float, thickness: float, poisson: float) -> float:
    """sqrt(t/k)/(3 (1 - nu^2))^(1/4): width of the curled strips of a plate of one material."""
    return float(np.sqrt(thickness / curvature) / (3.0 * (1.0 - poisson**2)) ** 0.25)


def plate_moment(x: float, poisson: float) -> float:
    """Moment per width and curvature of a bent plate, over its rigidity D, at x = width/edge width.

    M/(D k) = 1 - nu^2 ((3/2x)(cosh x - cos x)/(sinh x + sin x) + sinh x sin x/(sinh x + sin x)^2),

    the derivative of the least energy D k^2/2 (1 - nu^2 (2/x)(cosh x - cos x)/(sinh x + sin x)) with
    respect to k, on which x depends too.
    """
    below = np.sinh(x) + np.sin(x)
    bent = 1.5 / x * (np.cosh(x) - np.cos(x)) / below
    return float(1.0 - poisson**2 * (bent + np.sinh(x) * np.sin(x) / below**2))


def test_the_plate_moment_is_the_derivative_of_its_energy() -> None:
    def energy(k: float) -> float:
        x = 2.0 * np.sqrt(k)  # x = width/edge width, with 1 mm^2 for width^2 (3 (1 - nu^2))^(1/2)/t
        share = 2.0 / x * (np.cosh(x) - np.cos(x)) / (np.sinh(x) + np.sin(x))
        return float(0.5 * k**2 * (1.0 - 0.25 * share))

    for k in (0.1, 1.0, 4.0, 16.0):
        step = 1e-5 * k
        slope = (energy(k + step) - energy(k - step)) / (2 * step)
        # central differences: truncation and round-off of relative size 1e-10
        assert plate_moment(2.0 * np.sqrt(k), 0.5) == pytest.approx(slope / k, rel=1e-8)
    # from a beam to a plate that cannot curl across
    assert plate_moment(1e-3, 0.5) == pytest.approx(0.75, abs=1e-6)
    assert plate_moment(100.0, 0.5) == pytest.approx(1.0 - 0.25 * 1.5 / 100.0, abs=1e-12)


@pytest.mark.parametrize("width", [0.05, 0.2, 0.5, 1.0, 2.0])
def test_a_thin_active_layer_bends_a_plate_as_the_classical_moment_does(width: float) -> None:
    """sigma d_a t/2 = M(k, width): the layer's pull, and nothing else, bends the plate."""
    k, thickness, shear_modulus, layer = 0.02, 0.02, 500.0, 1e-7
    rigidity = 3.0 * shear_modulus * thickness**3 / 12.0 / 0.75
    share = plate_moment(width / edge_width(k, thickness, 0.5), 0.5)
    pull = rigidity * k * share / (0.5 * thickness)
    plies = [Ply(thickness, shear_modulus), Ply(layer, 1e-6, tension=prescribed(pull / layer))]
    # strains are k t = 4e-4, and finite strains change k by a few times that
    assert film_of_width(plies, width).curvature == pytest.approx(k, rel=1e-3)


def test_the_curvature_falls_from_the_strip_to_the_cylinder() -> None:
    strip, cylinder = free_strip(FILM).curvature_x, cylindrical(FILM).curvature_x
    found = [film_of_width(FILM, width).curvature for width in (0.01, 0.1, 0.3, 1.0, 3.0, 100.0)]
    assert found == sorted(found, reverse=True)
    # the section is linear about the cylinder; the strip departs from that by a strain of 0.2 %
    assert found[0] == pytest.approx(strip, rel=2e-3)
    # the sides' share of the width: 0.15/100 mm
    assert found[-1] == pytest.approx(cylinder, rel=1e-3)


def test_only_the_sides_of_a_wide_film_leave_the_cylinder() -> None:
    film = film_of_width(FILM, 4.0)
    side = np.abs(film.profile[-1])
    middle = np.abs(np.interp(1.0, film.across, film.profile))
    # seven edge widths away, but for the constant by which its surface is longer than the cylinder
    assert middle < 0.02 * side
    assert film.edge == pytest.approx(edge_width(film.curvature, 0.018, 0.5), rel=0.02)


def test_a_film_that_bends_the_other_way_is_refused() -> None:
    with pytest.raises(ValueError, match="upper side"):
        film_of_width(FILM[::-1], 1.0)
