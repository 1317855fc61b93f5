"""Elementary functions for model equations: plain Python here, fast vectorisable code once compiled.

A model file that writes ``exp(x)`` with this ``exp`` stays light to import and easy to test; the
compiled solvers replace it by :func:`stages.numerics.compiled.fast_exp`, and ``expm1`` likewise.
"""

from __future__ import annotations

import math


def exp(x: float) -> float:
    """Exponential that saturates instead of overflowing: the argument is clipped to [-708, 708].

    Examples
    --------
    >>> exp(0.0), exp(-1e9) < 1e-300, exp(1e9) > 1e300
    (1.0, True, True)
    """
    return math.exp(min(max(x, -708.0), 708.0))


def logistic(x: float) -> float:
    """1/(1 + exp(-x)), which is (1 + tanh(x/2))/2.

    Examples
    --------
    >>> logistic(0.0), logistic(1e9), logistic(-1e9) < 1e-300
    (0.5, 1.0, True)
    """
    return 1.0 / (1.0 + exp(-x))


def expm1(x: float) -> float:
    """exp(x) - 1 with all digits near x = 0; saturates as :func:`exp` does.

    Examples
    --------
    >>> expm1(1e-12)
    1.0000000000005e-12
    """
    return math.expm1(min(max(x, -708.0), 708.0))
