"""Quasi-static equilibrium under a growing activation, by load increments (eqs. 45, 52)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.body import Body
from stages.mechanics.imposed import Imposed
from stages.mechanics.time_step import TimeStep
from stages.numerics.bsplines import Array
from stages.numerics.halving import Advance, HalvedSteps
from stages.numerics.newton import NewtonControls, newton


@dataclass(frozen=True)
class Equilibrium:
    """Equilibrium at one fraction of the activation.

    Attributes
    ----------
    factor
        Fraction of the full activation.
    displacement
        Control displacements, mm, shape ``(dof,)``.
    slope
        d(displacement)/d(factor) over the last increment; the next guess follows it.
    """

    factor: float
    displacement: Array
    slope: Array


@dataclass(frozen=True)
class Increment:
    """The way from one fraction of the activation to a higher one."""

    start: float
    end: float

    remedy = "use more increments"

    @property
    def width(self) -> float:
        """Difference of the two fractions."""
        return self.end - self.start

    @property
    def place(self) -> str:
        """Fraction up to which equilibria were found."""
        return f"{self.start:.4g} of the activation"

    @property
    def extent(self) -> str:
        """Its width."""
        return f"{self.width:.2g} of the activation"

    def halves(self) -> tuple[Increment, Increment]:
        """Two increments of half the width."""
        middle = self.start + 0.5 * self.width
        return Increment(self.start, middle), Increment(middle, self.end)


@dataclass(frozen=True)
class LoadPath:
    """Equilibria of a body at equal fractions of what acts on it.

    Parameters
    ----------
    body
        The film with its supports and loads.
    target
        What acts in full.
    increments
        Number of fractions; Newton's basin is small on thin films (10 or more up to 10 kPa).
    controls
        Newton's tolerances.
    max_halvings
        How often an increment that fails may be halved.
    """

    body: Body
    target: Imposed
    increments: int
    controls: NewtonControls
    max_halvings: int

    def follow(self) -> Iterator[Advance[Equilibrium]]:
        """Equilibria at 1/n, 2/n, ..., 1; each is yielded before the next one is sought.

        Raises
        ------
        UnsolvedStepError
            If an increment fails in spite of halving; those before it have been yielded.
        """
        increments = HalvedSteps(self._guesses, self._solve, self.max_halvings)
        zero = np.zeros(self.body.shell.size)
        last = Equilibrium(0.0, zero, zero)
        for index in range(1, self.increments + 1):
            result = increments.advance(last, Increment(last.factor, index / self.increments))
            yield result
            last = result.state

    def _guesses(self, last: Equilibrium, part: Increment) -> tuple[Array]:
        return (last.displacement + part.width * last.slope,)

    def _solve(self, last: Equilibrium, part: Increment, guess: Array) -> tuple[Equilibrium, int]:
        imposed = self.body.nothing().towards(self.target, part.end)
        solution = newton(lambda u: self.body.linearise(u, imposed), guess, self.controls)
        slope = (solution.x - last.displacement) / part.width
        return Equilibrium(part.end, solution.x, slope), solution.iterations


@dataclass(frozen=True)
class Rest:
    """A shape in equilibrium.

    Attributes
    ----------
    displacement
        Control displacements, mm, shape ``(dof,)``.
    rate
        Its change per ms of loading over the last part of the way to it.
    work
        What loads and moved supports have done since the unloaded film, kPa mm^3.
    """

    displacement: Array
    rate: Array
    work: float


@dataclass(frozen=True)
class QuasiStatics:
    """Equilibria at equal intervals of a slow loading; an interval that fails is halved.

    Parameters
    ----------
    body
        The film with its supports and loads.
    controls
        Newton's tolerances.
    step
        Interval between two frames, ms.
    max_halvings
        How often an interval may be halved.
    """

    body: Body
    controls: NewtonControls
    step: float
    max_halvings: int

    def unloaded(self) -> Rest:
        """The film before anything acts."""
        zero = np.zeros(self.body.shell.size)
        return Rest(zero, zero, 0.0)

    def run(
        self, imposed: Callable[[int], Imposed], rest: Rest, first: int, last: int
    ) -> Iterator[Advance[Rest]]:
        """Frames ``first`` to ``last``, from ``rest`` at the frame before (frame 0: unloaded).

        ``imposed(i)`` is what acts in frame i; it is linear in between. The result depends on nothing
        else, so that a run may stop after any frame.

        Raises
        ------
        UnsolvedStepError
            If an interval fails in spite of halving; the frames before it have been yielded.
        """
        steps = HalvedSteps(self._guesses, self._solve, self.max_halvings)
        old = imposed(first - 1) if first else self.body.nothing()
        for index in range(first, last + 1):
            new = imposed(index)
            start = max(index - 1, 0) * self.step
            result = steps.advance(rest, TimeStep(index, start, self.step, old, new))
            yield result
            rest, old = result.state, new

    def _guesses(self, rest: Rest, part: TimeStep) -> Iterator[Array]:
        onward = rest.displacement + part.length * rest.rate
        yield onward
        if not np.array_equal(onward, rest.displacement):
            yield rest.displacement

    def _solve(self, rest: Rest, part: TimeStep, guess: Array) -> tuple[Rest, int]:
        solution = newton(lambda u: self.body.linearise(u, part.new), guess, self.controls)
        rate = (solution.x - rest.displacement) / part.length
        work = self.body.work_between(rest.displacement, part.old, solution.x, part.new)
        return Rest(solution.x, rate, rest.work + work), solution.iterations
