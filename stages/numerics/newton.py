"""Newton's method: one loop that owns tolerances, limits, history and errors (eq. 52).

:func:`iterates` is the method; :func:`newton` judges it. An iterate is accepted when its displacement,
energy and force are small together, because on thin shells |R| and |du| fall in zig-zag before the
quadratic drop: stretching modes are stiff (large forces, small motion), bending modes are soft. A
residual at its round-off floor is accepted too: nothing more is to be gained there. For the same reason the
line search, where it is allowed, cuts only corrections that make matters worse by orders of magnitude: one
that asks for less |R . du| at every iterate cripples the method on thin shells (seen: 60 iterations
instead of 8). A solution rescued by cuts may lie on another branch, so that smaller steps come first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.sparse import SingularMatrixError

ROUND_OFF = 16.0 * float(np.finfo(float).eps)
"""Relative residual that rounding the unknowns themselves already causes, with a margin."""

GROWTH = 1e3
"""Growth of |R . du| over one correction beyond which it is cut; whole ones that end well reach 1e3."""

CUT = 0.25
"""What is left of a correction after one cut."""


class Ahead(Protocol):
    """Linearisation after a correction, which may lead to another parameter value as well."""

    def __call__(self, correction: Array, parameter: float | None = None) -> Linearisation:
        """Residual of the new iterate; a tangent that may use what the old one predicts."""
        ...


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
    negative_pivots
        Number of negative eigenvalues of K, counted when asked for; None where nobody can tell.
    ahead
        Linearisation after a correction; None: linearise afresh.
    """

    residual: Array
    solve: Callable[[Array], Array]
    stiffness: float
    negative_pivots: Callable[[], int] | None = None
    ahead: Ahead | None = None

    @property
    def finite(self) -> bool:
        """Whether residual and tangent are numbers."""
        return bool(np.isfinite(self.residual).all() and np.isfinite(self.stiffness))

    @property
    def unstable_directions(self) -> int | None:
        """Number of negative eigenvalues of K, if it can be told."""
        return None if self.negative_pivots is None else self.negative_pivots()


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
    max_cuts
        How often one correction may be cut by the line search; 0: no line search.
    """

    length: float
    displacement_tolerance: float
    energy_tolerance: float
    force_tolerance: float
    max_iterations: int
    max_cuts: int = 0


@dataclass(frozen=True)
class Iteration:
    """Sizes of one iteration: max |R| and max K_ii before it, max |du| and |R . du| of its correction.

    ``cuts`` counts how often the correction before it had to be cut to get here.
    """

    force: float
    stiffness: float
    displacement: float
    energy: float
    cuts: int = 0


@dataclass(frozen=True)
class NewtonSolution:
    """Solution, the iterations that led to it, and the last tangent on the way."""

    x: Array
    history: tuple[Iteration, ...]
    system: Linearisation

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
    """An iterate left the domain of the equations."""

    cause = "Newton's method diverged"
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
    linearise: Callable[[Array], Linearisation], x: Array, max_cuts: int = 0
) -> Iterator[tuple[Array, Iteration, Linearisation]]:
    """Endless sequence x <- x - K(x)^-1 R(x), each with the sizes of the correction and its K.

    The line search cuts a correction only if its end has no finite residual, or a far larger one.

    Raises
    ------
    FloatingPointError
        If the residual or the correction is not finite, or explodes in spite of all cuts.
    SingularMatrixError
        If a tangent is singular.
    """
    system = linearise(x)
    if not system.finite:
        raise FloatingPointError("the residual is not finite")
    cuts = 0
    while True:
        correction = system.solve(-system.residual)
        if not np.isfinite(correction).all():
            raise FloatingPointError("the correction is not finite")
        size = Iteration(
            force=_largest(system.residual),
            stiffness=system.stiffness,
            displacement=_largest(correction),
            energy=abs(float(system.residual @ correction)),
            cuts=cuts,
        )
        yield x + correction, size, system
        x, system, cuts = _advance(linearise, x, system, correction, size, max_cuts)


def _advance(
    linearise: Callable[[Array], Linearisation],
    x: Array,
    system: Linearisation,
    correction: Array,
    size: Iteration,
    max_cuts: int,
) -> tuple[Array, Linearisation, int]:
    """Next iterate, its linearisation, and how often the correction was cut."""
    for cuts in range(max_cuts + 1):
        part = correction * CUT**cuts
        trial = linearise(x + part) if system.ahead is None else system.ahead(part)
        if not trial.finite:
            continue
        energy, force = abs(float(trial.residual @ correction)), _largest(trial.residual)
        if not max_cuts or energy <= GROWTH * size.energy or force <= size.force:
            return x + part, trial, cuts
    raise FloatingPointError(
        f"the residual explodes even over {CUT**max_cuts:.0e} of a correction"
        if max_cuts
        else "the residual is not finite"
    )


def _largest(vector: Array) -> float:
    return float(np.abs(vector).max(initial=0.0))


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
    method = iterates(linearise, start, controls.max_cuts)
    while len(history) < controls.max_iterations:
        try:
            x, iteration, system = next(method)
        except FloatingPointError as error:
            raise DivergenceError(history, f": {error}") from None
        except SingularMatrixError as error:
            raise SingularTangentError(history, f": {error}") from None
        history = (*history, iteration)
        if _small(history, controls):
            return NewtonSolution(x, history, system)
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
