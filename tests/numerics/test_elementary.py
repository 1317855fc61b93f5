"""Fast exponentials of the compiled solvers: accurate everywhere, saturating, and exp(x) - 1 near zero."""

from __future__ import annotations

import math

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.compiled import kernel
from stages.numerics.elementary import exp, expm1

NEAR = np.concatenate((-np.logspace(-18, 0, 200), np.logspace(-18, 0, 200)))
FAR = np.concatenate((np.linspace(-700, 700, 5001), np.linspace(-1e-3, 1e-3, 101)))


@kernel
def both(x: Array) -> tuple[Array, Array]:
    powers, excess = np.empty_like(x), np.empty_like(x)
    for i in range(x.size):
        powers[i], excess[i] = exp(x[i]), expm1(x[i])
    return powers, excess


def test_the_fast_exponential_is_accurate_and_saturates() -> None:
    found, _ = both(FAR)
    assert np.abs(found / np.exp(FAR) - 1).max() < 5e-16
    low, high, nothing = both(np.array([-1e300, 1e300, np.nan]))[0]
    assert 0 < low < 1e-300
    assert 1e300 < high < np.inf
    assert np.isnan(nothing)


def test_the_fast_exponential_minus_one_keeps_its_digits_near_zero() -> None:
    x = np.concatenate((NEAR, FAR[FAR != 0]))
    # two roundings more than the exponential; largest just below -ln(2)/2, where halves are added
    assert np.abs(both(x)[1] / np.expm1(x) - 1).max() < 1e-15
    assert both(np.zeros(1))[1][0] == 0.0
    assert both(np.array([-1e300]))[1][0] == -1.0


def test_the_plain_functions_are_those_of_the_library() -> None:
    assert [exp(x) for x in (0.0, -1.5)] == [math.exp(0.0), math.exp(-1.5)]
    assert [expm1(x) for x in (1e-9, -1.5)] == [math.expm1(1e-9), math.expm1(-1.5)]
