"""Modes of diffusion along one direction, and functions of the diffusion operator in their products."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from stages.numerics.bsplines import Array, SplineSpace
from stages.numerics.compiled import kernel

Complex = NDArray[np.complex128]

WORST_CONDITION = 1e6
"""Of the matrix of modes; beyond it the fast path would lose too many digits. Uniform meshes have 1 to 70."""


@dataclass(frozen=True)
class Modes:
    """Real modes of the one-dimensional collocated Laplacian: zero flux at both ends, or periodic.

    Collocation is not symmetric, so that eigenvalues may come in complex pairs alpha +- i beta: for
    degree 4 and more, two modes that live at one end each have the same eigenvalue to round-off. Real
    and imaginary part of the eigenvector are then two modes y, z that the operator mixes by

        (y, z) -> (alpha y + beta z, alpha z - beta y).

    Such pairs come first, at rows (0, 1), (2, 3), ...

    Attributes
    ----------
    to_control
        Control values of each mode, shape ``(n, n - 2)``.
    to_points
        Values of each mode at the Greville points, shape ``(n, n - 2)``.
    from_points
        Mode amplitudes from interior residuals, shape ``(n - 2, n)``; its end columns are zero.
    rates
        Eigenvalue of each mode with beta >= 0, 1/mm^2, real parts <= 0; both modes of a pair have the same.
    paired
        Number of modes that belong to pairs.
    """

    to_control: Array
    to_points: Array
    from_points: Array
    rates: Complex
    paired: int


def free_modes(space: SplineSpace, stiffness: float, closed: bool = False) -> Modes | None:
    """Modes of one direction; None if one of them would grow or they are nearly dependent.

    ``stiffness`` is D^aa, 1/mm^2 per unit of the parameter squared; ``closed``: the direction runs into
    itself, with one value and one slope at both ends.
    """
    greville = space.greville()
    values, slopes, bends = (space.evaluate(greville, k) for k in range(3))
    n = space.size
    ends = np.stack((values[0] - values[-1], slopes[0] - slopes[-1])) if closed else slopes[[0, -1]]
    free = np.zeros((n, n - 2))
    free[1:-1] = np.eye(n - 2)
    free[[0, -1]] = -np.linalg.solve(ends[:, [0, -1]], ends[:, 1:-1])
    mass = values[1:-1] @ free
    rates, vectors = eig(stiffness * bends[1:-1] @ free, mass)
    if rates.real.max() > 1e-9 * np.abs(rates).max():
        return None
    rates, modes, paired = _real_modes(rates, vectors)
    if np.linalg.cond(modes) > WORST_CONDITION:
        return None
    from_points = np.zeros((n - 2, n))
    from_points[:, 1:-1] = np.linalg.inv(mass @ modes)
    to_control = free @ modes
    return Modes(to_control, values @ to_control, from_points, rates, paired)


def _real_modes(rates: Complex, vectors: Complex) -> tuple[Complex, Array, int]:
    """Pairs first, then the real modes from the slowest to the fastest."""
    pairs = np.flatnonzero(rates.imag > 0)
    real = np.flatnonzero(rates.imag == 0)
    real = real[np.argsort(-rates.real[real], kind="stable")]
    both = np.stack((vectors[:, pairs].real, vectors[:, pairs].imag), axis=-1)
    modes = np.hstack((both.reshape(len(vectors), -1), vectors[:, real].real))
    ordered = np.concatenate((np.repeat(rates[pairs], 2), rates[real]))
    return ordered, modes, 2 * pairs.size


class Factors(NamedTuple):
    """A function of the sum of both directions' operators, in products of real modes.

    Attributes
    ----------
    same
        Factor of each product, shape ``(n1 - 2, n2 - 2)``.
    first, second, both
        What the other mode of its pair adds, in direction 1, in direction 2, in both; only rows and
        columns that belong to pairs.
    """

    same: Array
    first: Array
    second: Array
    both: Array


def factors(
    first: Modes, second: Modes, function: Callable[[Complex], Complex], scale: float = 1.0
) -> Factors:
    """``function(scale (l1 + l2))`` for all products of modes; it must be real on the real axis.

    Within a pair the operator is alpha + beta J with J^2 = -1, and the J of both directions commute;
    hence f = c + c1 J1 + c2 J2 + c12 J1 J2, with the coefficients that f(l1 + l2) and f(l1 + conj l2) give.
    """
    l1, l2 = first.rates[:, None], second.rates[None, :]
    alike, opposed = function(scale * (l1 + l2)), function(scale * (l1 + l2.conj()))
    sign1 = np.where(np.arange(first.paired) % 2, -1.0, 1.0)[:, None]
    sign2 = np.where(np.arange(second.paired) % 2, -1.0, 1.0)[None, :]
    p1, p2 = first.paired, second.paired
    return Factors(
        np.ascontiguousarray(0.5 * (alike.real + opposed.real)),
        sign1 * 0.5 * (alike.imag + opposed.imag)[:p1],
        sign2 * 0.5 * (alike.imag - opposed.imag)[:, :p2],
        sign1 * sign2 * 0.5 * (opposed.real - alike.real)[:p1, :p2],
    )


@kernel
def multiply(by: Any, modes: Any, out: Any) -> None:
    """``out`` = the function of the operator, applied to amplitudes ``modes``; not in place."""
    for a in range(modes.shape[0]):
        for b in range(modes.shape[1]):
            out[a, b] = by.same[a, b] * modes[a, b]
    for a in range(by.first.shape[0]):
        for b in range(modes.shape[1]):
            out[a, b] += by.first[a, b] * modes[a ^ 1, b]
    for a in range(modes.shape[0]):
        for b in range(by.second.shape[1]):
            out[a, b] += by.second[a, b] * modes[a, b ^ 1]
    for a in range(by.both.shape[0]):
        for b in range(by.both.shape[1]):
            out[a, b] += by.both[a, b] * modes[a ^ 1, b ^ 1]
