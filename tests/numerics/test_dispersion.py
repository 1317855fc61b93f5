"""How collocation at Greville points sees waves: why odd degrees are no better than the even ones below."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from stages.numerics.bsplines import SplineSpace

LEADING = {
    2: Fraction(1, 24),
    3: Fraction(1, 12),
    4: Fraction(7, 1920),
    5: Fraction(1, 720),
    6: Fraction(31, 193536),
}
"""C in N^-1 N'' exp(i k x) = -k^2 (1 + C (k h)^m) exp(i k x), with m = p for even and p - 1 for odd p:
the series of the symbol of cardinal splines, at middles of spans for even and at knots for odd p."""


@pytest.mark.parametrize("degree", LEADING)
def test_waves_are_diffused_too_fast_by_a_power_of_the_mesh(degree: int) -> None:
    space = SplineSpace.uniform(degree, 40, 0.0, 40.0)  # h = 1
    points = space.greville()
    middle = space.size // 2
    wave = 0.4
    phases = np.exp(1j * wave * (points - points[middle]))
    value, bend = (space.evaluate(points[[middle]], order)[0] @ phases for order in (0, 2))
    excess = -(bend / value).real / wave**2 - 1.0
    power = degree if degree % 2 == 0 else degree - 1
    # the next term of the series is below (k h)^2/3 = 0.05 of the leading one for p = 2 and 3, and
    # below 0.11, 0.19 and 0.13 of it for p = 4, 5 and 6, where the waves are the same
    assert excess / wave**power == pytest.approx(float(LEADING[degree]), rel=0.2)
