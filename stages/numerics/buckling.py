"""Buckling loads and modes: eigenvalues of the tangent stiffness and of its change with the load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse.linalg import ArpackError, ArpackNoConvergence, LinearOperator, eigsh

from stages.numerics.bsplines import Array

DENSE = 60
"""Size up to which the whole spectrum is computed; Lanczos' method needs room for its vectors."""


class Matrix(Protocol):
    """What is asked of a symmetric matrix."""

    def __matmul__(self, vector: Array, /) -> Array: ...


@dataclass(frozen=True)
class Modes:
    """Eigenvalues in the order of their modulus, and their modes, one a row."""

    values: Array
    shapes: Array


class NoModesError(Exception):
    """Eigenvalues were asked for that do not exist, or were not found; ``remedy`` says what to try."""

    def __init__(
        self,
        cause: str,
        remedy: str = "ask for fewer modes, or look at a state closer to the critical load",
    ) -> None:
        self.remedy = remedy
        super().__init__(cause)


def buckling_modes(
    at_rest: Matrix,
    solve: Callable[[Array], Array],
    loaded: Matrix,
    free: NDArray[np.bool_],
    number: int,
) -> Modes:
    """Load factors lambda and modes of (K0 + lambda (K1 - K0)) phi = 0, smallest |lambda| first.

    Parameters
    ----------
    at_rest, solve
        K0, positive definite on the free unknowns, and the solution of K0 x = b there.
    loaded
        K1, the tangent under the reference load, in the state that it causes.
    free
        Unknowns that are not held.
    number
        How many. Negative factors mean that the reversed load buckles the body.

    Returns
    -------
    Modes
        Modes have unit strain energy: phi . K0 phi = 1.

    Raises
    ------
    NoModesError
        If the load changes no stiffness, or fewer modes exist.

    Notes
    -----
    Solved as -(K1 - K0) phi = (1/lambda) K0 phi, whose largest |1/lambda| Lanczos' method finds first.
    """
    size = _enough(free, number)

    def softening(b: Array) -> Array:
        full = _spread(b, free)
        return np.asarray((at_rest @ full - loaded @ full)[free])

    def stiff(b: Array) -> Array:
        return np.asarray((at_rest @ _spread(b, free))[free])

    if size <= DENSE:
        inverse, shapes = eigh(_dense(softening, size), _dense(stiff, size))
    else:
        inverse, shapes = _lanczos(
            size,
            number,
            A=_operator(softening, size),
            M=_operator(stiff, size),
            Minv=_operator(lambda b: solve(_spread(b, free))[free], size),
            which="LM",
        )
    order = np.argsort(-np.abs(inverse))[:number]
    if np.any(np.abs(inverse[order]) < 1e-14):
        raise NoModesError(
            "the load changes the stiffness in fewer directions than modes asked for"
        )
    return Modes(1.0 / inverse[order], _rows(shapes[:, order], free))


def softest_modes(
    tangent: Matrix, solve: Callable[[Array], Array], free: NDArray[np.bool_], number: int
) -> Modes:
    """Eigenvalues of a tangent stiffness next to zero, and their modes of unit length.

    Parameters
    ----------
    tangent, solve
        K and the solution of K x = b.
    free
        Unknowns that are not held.
    number
        How many.

    Raises
    ------
    NoModesError
        If the eigenvalues do not exist or were not found.
    """
    size = _enough(free, number)

    def product(b: Array) -> Array:
        return np.asarray((tangent @ _spread(b, free))[free])

    if size <= DENSE:
        values, shapes = eigh(_dense(product, size))
    else:
        values, shapes = _lanczos(
            size,
            number,
            A=_operator(product, size),
            OPinv=_operator(lambda b: solve(_spread(b, free))[free], size),
            sigma=0.0,
            which="LM",
        )
    order = np.argsort(np.abs(values))[:number]
    return Modes(values[order], _rows(shapes[:, order], free))


def _enough(free: NDArray[np.bool_], number: int) -> int:
    size = int(free.sum())
    if number < 1 or number > size:
        raise NoModesError(f"{number} modes were asked for, but there are {size} free unknowns")
    return size


def _lanczos(size: int, number: int, **problem: Any) -> tuple[Array, Array]:
    start = np.random.default_rng(0).normal(size=size)  # the same modes in every run
    try:
        values, shapes = eigsh(k=number, v0=start, **problem)
    except ArpackNoConvergence as error:
        raise NoModesError(f"only {len(error.eigenvalues)} of {number} modes were found") from error
    except ArpackError as error:
        raise NoModesError(f"there are no modes to be found ({error})") from error
    return np.asarray(values), np.asarray(shapes)


def _operator(product: Callable[[Array], Array], size: int) -> LinearOperator:
    return LinearOperator((size, size), matvec=lambda b: product(np.ravel(b)), dtype=float)


def _dense(product: Callable[[Array], Array], size: int) -> Array:
    columns = np.stack([product(column) for column in np.eye(size)], axis=1)
    return 0.5 * (columns + columns.T)


def _spread(values: Array, free: NDArray[np.bool_]) -> Array:
    full = np.zeros(free.size)
    full[free] = values
    return full


def _rows(shapes: Array, free: NDArray[np.bool_]) -> Array:
    """Modes as rows over all unknowns, with the largest component positive."""
    full = np.zeros((shapes.shape[1], free.size))
    full[:, free] = shapes.T
    largest = np.argmax(np.abs(full), axis=1)
    return np.asarray(full * np.sign(full[np.arange(full.shape[0]), largest])[:, None])
