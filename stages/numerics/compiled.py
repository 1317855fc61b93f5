"""Compilation of kernels: one set of numba options, and a fast exponential.

Importing this module costs what importing numba costs; only code that is about to compute does so.
Kernels are compiled in the process that runs them and never cached on disk: a cached kernel does not
notice that a function it calls in another module was edited.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic, overload

from stages.numerics import elementary

Function = TypeVar("Function", bound=Callable[..., Any])

_LOG2_E = 1.4426950408889634
_LN2_HIGH = 0.693147180369123816490
_LN2_LOW = 1.90821492927058770002e-10
_ROUND = 6755399441055744.0  # 1.5 * 2**52: adding it leaves the nearest integer in the low bits


_OPTIONS: Any = {
    "error_model": "numpy",
    "nogil": True,
    "fastmath": {"contract", "nsz"},
    "no_cfunc_wrapper": True,  # nobody calls back from C: less to compile
}
_INLINED: Any = {**_OPTIONS, "forceinline": True, "no_cpython_wrapper": True}


def kernel(function: Function) -> Function:
    """Compile for speed: NumPy division rules, no GIL, fused multiply-add, NaN and inf kept."""
    return cast(Function, numba.njit(**_OPTIONS)(function))


def inlined(function: Function, reciprocals: bool = False) -> Function:
    """The same for a scalar function that a loop calls: put into the loop, so that it vectorises.

    Only compiled code can call it. An entry for Python would take longer to compile than the function.
    With ``reciprocals`` a quotient x/c may become x (1/c), with 1/c taken once before the loop: one more
    rounding instead of a division for every point.
    """
    fast = {"fastmath": _OPTIONS["fastmath"] | {"arcp"}} if reciprocals else {}
    return cast(Function, numba.njit(**_INLINED | fast)(function))


def _bits_of(typing_context: Any, value: Any) -> Any:
    """Bit pattern of a float64 as int64."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.IntType(64))

    return types.int64(types.float64), generate


def _float_of(typing_context: Any, value: Any) -> Any:
    """float64 with the bit pattern of an int64."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], ir.DoubleType())

    return types.float64(types.int64), generate


_bits: Any = intrinsic(_bits_of)
_float: Any = intrinsic(_float_of)


@inlined
def fast_exp(x: float) -> float:
    """Exponential in plain arithmetic, so that a loop over points becomes SIMD code.

    x = n ln 2 + r with |r| <= ln 2 / 2, a Taylor polynomial of degree 13 in r (remainder below
    5e-18 relative), and 2**n put into the exponent bits. Arguments are clipped to [-708, 708];
    relative error below 4e-16.
    """
    power, r, series = _reduced(x)
    return (series * r + 1.0) * power


@inlined
def fast_expm1(x: float) -> float:
    """exp(x) - 1 from the same parts: (2^n - 1) + 2^n (exp(r) - 1), without a difference near 0."""
    power, r, series = _reduced(x)
    return (power - 1.0) + power * (series * r)


@inlined
def _reduced(x: float) -> tuple[float, float, float]:
    """2^n, r, and the series s with exp(r) = 1 + r s."""
    x = -708.0 if x < -708.0 else x
    x = 708.0 if x > 708.0 else x
    shifted = x * _LOG2_E + _ROUND
    n = shifted - _ROUND
    r = (x - n * _LN2_HIGH) - n * _LN2_LOW
    s = 1.0 / 6227020800.0
    s = s * r + 1.0 / 479001600.0
    s = s * r + 1.0 / 39916800.0
    s = s * r + 1.0 / 3628800.0
    s = s * r + 1.0 / 362880.0
    s = s * r + 1.0 / 40320.0
    s = s * r + 1.0 / 5040.0
    s = s * r + 1.0 / 720.0
    s = s * r + 1.0 / 120.0
    s = s * r + 1.0 / 24.0
    s = s * r + 1.0 / 6.0
    s = s * r + 0.5
    s = s * r + 1.0
    return _float((_bits(shifted) + 1023) << 52), r, s


def _compiled_exp(x: float) -> Any:
    def implementation(x: float) -> float:
        return fast_exp(x)

    return implementation


def _compiled_logistic(x: float) -> Any:
    def implementation(x: float) -> float:
        return 1.0 / (1.0 + fast_exp(-x))

    return implementation


def _compiled_expm1(x: float) -> Any:
    def implementation(x: float) -> float:
        return fast_expm1(x)

    return implementation


overload(elementary.exp, jit_options=_INLINED, inline="always")(_compiled_exp)
overload(elementary.logistic, jit_options=_INLINED, inline="always")(_compiled_logistic)
overload(elementary.expm1, jit_options=_INLINED, inline="always")(_compiled_expm1)
