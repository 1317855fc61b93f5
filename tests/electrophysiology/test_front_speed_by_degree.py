"""A front runs as much too fast as the waves it is made of are diffused too fast."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from scipy.interpolate import CubicSpline

from stages.artefacts import ExcitableSurface
from stages.electrophysiology.front import tissue_front
from stages.electrophysiology.stage import electrophysiology
from stages.numerics.patches import Patch
from tests.numerics.test_dispersion import LEADING
from tests.paper import electrophysiology_config


@cache
def slowness(degree: int, spans: int) -> float:
    """Time per way between X = 1 and 2.5 mm, ms/mm."""
    config = electrophysiology_config(
        elements=(spans, 2), degree=degree, duration=160.0, n_steps=640, scheme="strang"
    )
    patch = Patch.rectangle(3.5, 2.0).refine(degree, (spans, 2))
    history = electrophysiology.compute(config, ExcitableSurface(patch))
    times = np.asarray(history.activation_times)[:, 0].reshape(patch.first.size, -1)[:, 1]
    reached = np.isfinite(times)
    arrival = CubicSpline(3.5 * patch.first.greville()[reached], times[reached])
    return float(arrival(2.5) - arrival(1.0)) / 1.5


def sensitivity(power: int, threshold: float) -> float:
    """Relative gain in speed of the front u = 1/(1 + exp(x)) per excess of (k^power) in diffusion.

    To first order, by the adjoint exp(c x) u' of its linearised equation; derivatives of u are
    polynomials in u, since u' = -u (1 - u).
    """
    speed = 1.0 - 2.0 * threshold
    x = np.linspace(-60.0, 60.0, 24001)
    u = 1.0 / (1.0 + np.exp(x))
    derivatives = [Polynomial([0.0, 1.0])]
    for _ in range(power + 2):
        derivatives.append(derivatives[-1].deriv() * Polynomial([0.0, -1.0, 1.0]))
    adjoint = np.exp(speed * x) * derivatives[1](u)
    gained = (adjoint * derivatives[power + 2](u)).sum() * (-1) ** (power // 2)
    return float(gained / -(adjoint * derivatives[1](u)).sum() / speed)


@pytest.mark.parametrize(("degree", "spans"), [(2, 102), (3, 102), (4, 51)])
def test_the_error_of_the_front_speed_is_that_of_the_dispersion(degree: int, spans: int) -> None:
    front = tissue_front(electrophysiology_config())
    assert front is not None
    power = degree - degree % 2
    length = front.width / (2.0 * math.log(9.0))
    expected = float(LEADING[degree]) * (3.5 / spans / length) ** power * sensitivity(power, 0.15)
    found = slowness(6, 72) / slowness(degree, spans) - 1.0
    # first order in the error, the next power of h, recovery left out: within 4 % when measured
    assert found == pytest.approx(expected, rel=0.1)
