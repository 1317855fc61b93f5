"""Adaptive steps along a path R(x, s) = 0 through given values of s, every one of which is hit exactly.

A step grows after an easy solve, shrinks after a hard one and is halved after a failure. The first iterate
extrapolates the last two solutions. Every solution is yielded before the next one is sought, so that all
of them survive a path that cannot be completed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from stages.numerics.bsplines import Array
from stages.numerics.newton import (
    Iteration,
    Linearisation,
    NewtonControls,
    NewtonError,
    NewtonSolution,
    newton,
)


class PathProblem(Protocol):
    """Equations that change with a parameter."""

    def linearise(self, x: Array, s: float) -> Linearisation:
        """Residual R(x, s) and tangent dR/dx."""
        ...

    def admissible(self, x: Array, s: float) -> Array:
        """``x`` with the unknowns that are prescribed at ``s`` in place."""
        ...


@dataclass(frozen=True)
class StepControls:
    """How long a step may be.

    Attributes
    ----------
    initial, smallest
        Length of the first step, and the length below which a failing one is given up.
    wanted_iterations
        Iterations of a step that is just right: the next one is as much longer as this one was easier,
        by a factor of 2 at most either way.
    rescue_cuts
        Cuts of the line search that the smallest step may use as a last resort, from the last
        solution itself.
    """

    initial: float
    smallest: float
    wanted_iterations: int = 8
    rescue_cuts: int = 6

    def next_length(self, length: float, iterations: int) -> float:
        """Length after a step that took so many iterations."""
        factor = min(2.0, max(0.5, self.wanted_iterations / max(iterations, 1)))
        return max(length * factor, min(length, self.smallest))


@dataclass(frozen=True)
class PathPoint:
    """A solution on the path.

    Attributes
    ----------
    s, x
        Parameter and solution.
    slope
        dx/ds over the step that led here; None at a start from which nothing is known.
    length
        Length that the next step should have.
    target
        Number of the target that this is, or None between two of them.
    iterations
        Newton iterations since the last point, those of failed attempts included.
    smallest_step
        Shortest step since the last target.
    unstable_directions
        Negative eigenvalues of the tangent, where they can be counted.
    """

    s: float
    x: Array
    slope: Array | None = None
    length: float | None = None
    target: int | None = None
    iterations: int = 0
    smallest_step: float = math.inf
    unstable_directions: int | None = None


@dataclass(frozen=True)
class Attempt:
    """One step that was tried, as a listener sees it."""

    start: float
    end: float
    history: tuple[Iteration, ...]
    failure: NewtonError | None = None

    def __str__(self) -> str:
        count = len(self.history)
        how = f"{count} iteration" + ("s" if count != 1 else "")
        if self.history:
            first, last = self.history[0], self.history[-1]
            how += (
                f", max |R| {first.force:.1e} to {last.force:.1e}, last |du| "
                f"{last.displacement:.1e}, last |R.du| {last.energy:.1e}"
            )
        cuts = sum(i.cuts for i in self.history)
        how += f", {cuts} cuts" if cuts else ""
        return how if self.failure is None else f"failed after {how}: {self.failure.cause}"


class PathEndError(Exception):
    """The path could not be followed any further.

    Attributes
    ----------
    reached
        Last solution found.
    failure
        What went wrong beyond it; ``history`` has its iterations.
    remedy
        What to try.
    """

    def __init__(self, reached: PathPoint, step: float, failure: NewtonError) -> None:
        self.reached = reached
        self.step = step
        self.failure = failure
        self.history = failure.history
        self.remedy = f"{failure.remedy}; if the path turns back here, follow it by arc length"
        super().__init__(
            f"no solution beyond {reached.s:.6g}, not even over a step of {step:.2g}: {failure}"
        )


def ignore(_: Attempt) -> None:
    """Listener that does not listen."""


def follow(
    problem: PathProblem,
    start: PathPoint,
    targets: Sequence[float],
    steps: StepControls,
    controls: NewtonControls,
    listen: Callable[[Attempt], None] = ignore,
) -> Iterator[PathPoint]:
    """Solutions from ``start`` through all ``targets`` in order, those between them included.

    Parameters
    ----------
    problem
        The equations.
    start
        A solution, whose ``slope`` and ``length`` are used if it has them.
    targets
        Increasing values of s beyond ``start``; the point there has ``s`` equal to it to the bit.
    steps, controls
        How long a step may be, and Newton's tolerances.
    listen
        Told of every attempt.

    Raises
    ------
    PathEndError
        If the smallest step fails; the points before it have been yielded.

    Examples
    --------
    >>> class Parabola:  # x^2 = 1 + s
    ...     def linearise(self, x, s):
    ...         return Linearisation(x**2 - 1.0 - s, lambda b: b / (2.0 * x), float(2.0 * x[0]))
    ...     def admissible(self, x, s):
    ...         return x
    >>> controls = NewtonControls(1.0, 1e-7, 1e-8, 1e-9, max_iterations=15)
    >>> steps = StepControls(initial=1.0, smallest=0.01)
    >>> path = follow(Parabola(), PathPoint(0.0, np.ones(1)), [3.0, 8.0], steps, controls)
    >>> [(p.s, round(float(p.x[0]), 9)) for p in path if p.target is not None]
    [(3.0, 2.0), (8.0, 3.0)]
    """
    last = start
    for number, target in enumerate(targets):
        if not target > last.s:
            raise ValueError(f"target {number} at {target:g} does not lie beyond {last.s:g}")
        last = replace(last, smallest_step=math.inf, target=None)
        while last.target is None:
            last = _step(problem, last, number, target, steps, controls, listen)
            yield last


def _step(
    problem: PathProblem,
    last: PathPoint,
    number: int,
    target: float,
    steps: StepControls,
    controls: NewtonControls,
    listen: Callable[[Attempt], None],
) -> PathPoint:
    """Next point: the target, or one on an even division of the way to it."""
    wanted = last.length or steps.initial
    remaining = target - last.s
    parts = max(1, math.ceil(remaining / wanted * (1.0 - 1e-9)))
    wasted = 0
    while True:
        step = remaining / parts
        s = target if parts == 1 else last.s + step
        try:
            solution = _attempt(problem, last, s, controls, listen)
        except NewtonError as failure:
            wasted += len(failure.history)
            if 0.5 * step >= steps.smallest:
                parts *= 2
                continue
            try:
                searching = replace(controls, max_cuts=steps.rescue_cuts)
                solution = _attempt(problem, replace(last, slope=None), s, searching, listen)
            except NewtonError as last_failure:
                raise PathEndError(last, step, last_failure) from last_failure
        length = steps.next_length(step, solution.iterations)
        return PathPoint(
            s=s,
            x=solution.x,
            slope=(solution.x - last.x) / step,
            # an easy step cut short by a target says nothing against the longer one that was wanted
            length=length if wasted or length < step else max(length, wanted),
            target=number if parts == 1 else None,
            iterations=wasted + solution.iterations,
            smallest_step=min(last.smallest_step, step),
            unstable_directions=solution.system.unstable_directions,
        )


def _attempt(
    problem: PathProblem,
    last: PathPoint,
    s: float,
    controls: NewtonControls,
    listen: Callable[[Attempt], None],
) -> NewtonSolution:
    """Solution at ``s``, from the extrapolation of the last two."""
    guess = last.x if last.slope is None else last.x + (s - last.s) * last.slope
    try:
        with np.errstate(all="ignore"):  # an overshoot is found by its residual
            solution = newton(
                lambda x: problem.linearise(x, s), problem.admissible(guess, s), controls
            )
    except NewtonError as failure:
        listen(Attempt(last.s, s, failure.history, failure))
        raise
    listen(Attempt(last.s, s, solution.history))
    return solution
