"""Newton's method: one loop that owns tolerances, limits, history and errors (eq. 52).

:func:`iterates` is the method; :func:`newton` judges it. An iterate is accepted when its displacement,
energy and force are small together, because on thin shells |R| and |du| fall in zig-zag before the
quadratic drop: stretching modes are stiff (large forces, small motion), bending modes are soft. A
residual at its round-off floor is accepted too: nothing more is to be gained there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.sparse import SingularMatrixError

ROUND_OFF = 16.0 * float(np.finfo(float).eps)
"""Relative residual that rounding the unknowns themselves already causes, with a margin."""


@dataclass(frozen=True)
class Linearisation:
    """Residual and tangent at one iterate.

    Attributes
    ----------
    residual
        R, shape ``(unknown,)``; zero where the unknown is prescribed.
    solve
        Solution of K x = b; raises :class:`SingularMatrixError`.
    stiffness
        Largest diagonal entry of K; times a length it is the scale of forces.
    """

    residual: Array
    solve: Callable[[Array], Array]
    stiffness: float


@dataclass(frozen=True)
class NewtonControls:
    """When to stop.

    Attributes
    ----------
    length
        Scale of the unknowns, for instance the extent of the body in mm.
    displacement_tolerance
        Accepted max |du|, relative to ``length``. The correction is still applied, so that the error
        left is of the order of its square.
    energy_tolerance
        Accepted |R . du|, relative to the largest one of the same solve.
    force_tolerance
        Accepted max |R|, relative to stiffness times ``length``.
    max_iterations
        Corrections before giving up.
    """

    length: float
    displacement_tolerance: float
    energy_tolerance: float
    force_tolerance: float
    max_iterations: int


@dataclass(frozen=True)
class Iteration:
    """Sizes of one iteration: max |R| and max K_ii before it, max |du| and |R . du| of its correction."""

    force: float
    stiffness: float
    displacement: float
    energy: float


@dataclass(frozen=True)
class NewtonSolution:
    """Solution and the iterations that led to it."""

    x: Array
    history: tuple[Iteration, ...]

    @property
    def iterations(self) -> int:
        """Number of linear systems solved."""
        return len(self.history)


class NewtonError(Exception):
    """Newton's method found no solution; ``history`` says how it went, ``remedy`` what to try."""

    cause = "Newton's method failed"
    remedy = "take smaller steps"

    def __init__(self, history: tuple[Iteration, ...], detail: str = "") -> None:
        self.history = history
        residuals = ", ".join(f"{i.force:.2e}" for i in history) or "none"
        super().__init__(f"{self.cause}{detail} (max |R| by iteration: {residuals})")


class DivergenceError(NewtonError):
    """An iterate left the domain of the equations: residual or correction is not finite."""

    cause = "Newton's method diverged: the residual is not finite"
    remedy = "take smaller steps: the last correction overshot"


class SingularTangentError(NewtonError):
    """The tangent has no inverse."""

    cause = "the tangent is singular"
    remedy = "check the supports: the body may move rigidly, or has reached a limit load"


class IterationLimitError(NewtonError):
    """The iteration limit was reached."""

    cause = "Newton's method did not converge"
    remedy = "take smaller steps, or allow more iterations"


def iterates(
    linearise: Callable[[Array], Linearisation], x: Array
) -> Iterator[tuple[Array, Iteration]]:
    """Endless sequence x <- x - K(x)^-1 R(x), each with the sizes of the correction.

    Raises
    ------
    FloatingPointError
        If the residual or the correction is not finite.
    SingularMatrixError
        If a tangent is singular.
    """
    while True:
        system = linearise(x)
        if not np.isfinite(system.residual).all() or not np.isfinite(system.stiffness):
            raise FloatingPointError("the residual is not finite")
        correction = system.solve(-system.residual)
        if not np.isfinite(correction).all():
            raise FloatingPointError("the correction is not finite")
        x = x + correction
        yield (
            x,
            Iteration(
                force=float(np.abs(system.residual).max(initial=0.0)),
                stiffness=system.stiffness,
                displacement=float(np.abs(correction).max(initial=0.0)),
                energy=abs(float(system.residual @ correction)),
            ),
        )


def newton(
    linearise: Callable[[Array], Linearisation], start: Array, controls: NewtonControls
) -> NewtonSolution:
    """Solution of R(x) = 0 near ``start``.

    Parameters
    ----------
    linearise
        Residual and tangent at an iterate.
    start
        First guess, with prescribed unknowns at their values.
    controls
        Tolerances and limits.

    Raises
    ------
    DivergenceError, SingularTangentError, IterationLimitError
        With the history of the iteration.

    Examples
    --------
    >>> def root_of_two(x):
    ...     return Linearisation(x**2 - 2.0, lambda b: b / (2.0 * x), float(2.0 * x[0]))
    >>> controls = NewtonControls(1.0, 1e-7, 1e-8, 1e-9, max_iterations=15)
    >>> solution = newton(root_of_two, np.array([1.0]), controls)
    >>> round(float(solution.x[0]), 12), solution.iterations
    (1.414213562373, 5)
    """
    history: tuple[Iteration, ...] = ()
    method = iterates(linearise, start)
    while len(history) < controls.max_iterations:
        try:
            x, iteration = next(method)
        except FloatingPointError:
            raise DivergenceError(history) from None
        except SingularMatrixError as error:
            raise SingularTangentError(history, f": {error}") from None
        history = (*history, iteration)
        if _small(history, controls):
            return NewtonSolution(x, history)
    raise IterationLimitError(history, f" within {controls.max_iterations} iterations")


def _small(history: tuple[Iteration, ...], controls: NewtonControls) -> bool:
    last = history[-1]
    scale = last.stiffness * controls.length
    if last.force <= ROUND_OFF * scale:
        return True
    return (
        last.displacement <= controls.displacement_tolerance * controls.length
        and last.energy <= controls.energy_tolerance * max(i.energy for i in history)
        and last.force <= controls.force_tolerance * scale
    )
