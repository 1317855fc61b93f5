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


_OPTIONS: Any = {"error_model": "numpy", "nogil": True, "fastmath": {"contract", "nsz"}}


def kernel(function: Function) -> Function:
    """Compile for speed: NumPy division rules, no GIL, fused multiply-add, NaN and inf kept."""
    return cast(Function, numba.njit(**_OPTIONS)(function))


def inlined(function: Function) -> Function:
    """The same for a scalar function that a loop calls: put into the loop, so that it vectorises."""
    return cast(Function, numba.njit(forceinline=True, **_OPTIONS)(function))


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
    s = s * r + 1.0
    return s * _float((_bits(shifted) + 1023) << 52)


def _compiled_exp(x: float) -> Any:
    def implementation(x: float) -> float:
        return fast_exp(x)

    return implementation


_exp_options: Any = {"forceinline": True, **_OPTIONS}
overload(elementary.exp, jit_options=_exp_options, inline="always")(_compiled_exp)
