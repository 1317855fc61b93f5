"""Quasi-static equilibrium under a growing activation, by load increments (eqs. 45, 52)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.constraints import Fixed
from stages.mechanics.dynamics import TimeStep
from stages.mechanics.shell import Shell, ShellResponse
from stages.numerics.bsplines import Array
from stages.numerics.halving import Advance, HalvedSteps
from stages.numerics.inertia import negative_pivots
from stages.numerics.newton import Linearisation, NewtonControls, newton


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
    """Equilibria of a shell at equal fractions of an activation.

    Parameters
    ----------
    shell, fixed
        The shell and its held degrees of freedom.
    activation
        Full activation, shape ``(quadrature point,)``, kPa.
    increments
        Number of fractions; Newton's basin is small on thin films (10 or more up to 10 kPa).
    controls
        Newton's tolerances.
    max_halvings
        How often an increment that fails may be halved.
    """

    shell: Shell
    fixed: Fixed
    activation: Array
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
        zero = np.zeros(self.shell.size)
        last = Equilibrium(0.0, zero, zero)
        for index in range(1, self.increments + 1):
            result = increments.advance(last, Increment(last.factor, index / self.increments))
            yield result
            last = result.state

    def _guesses(self, last: Equilibrium, part: Increment) -> tuple[Array]:
        return (last.displacement + part.width * last.slope,)

    def _solve(self, last: Equilibrium, part: Increment, guess: Array) -> tuple[Equilibrium, int]:
        solution = newton(
            lambda u: _linearise(self.shell, self.fixed, u, part.end * self.activation),
            guess,
            self.controls,
        )
        slope = (solution.x - last.displacement) / part.width
        return Equilibrium(part.end, solution.x, slope), solution.iterations


@dataclass(frozen=True)
class Rest:
    """A shape in equilibrium, and its change per ms of loading over the last part of the way to it."""

    displacement: Array
    rate: Array


@dataclass(frozen=True)
class QuasiStatics:
    """Equilibria at equal intervals of a slow loading; an interval that fails is halved.

    Parameters
    ----------
    shell, fixed
        The shell and its held degrees of freedom.
    controls
        Newton's tolerances.
    step
        Interval between two frames, ms.
    max_halvings
        How often an interval may be halved.
    """

    shell: Shell
    fixed: Fixed
    controls: NewtonControls
    step: float
    max_halvings: int

    def unloaded(self) -> Rest:
        """The film before anything acts."""
        zero = np.zeros(self.shell.size)
        return Rest(zero, zero)

    def run(
        self, activation: Callable[[int], Array], rest: Rest, first: int, last: int
    ) -> Iterator[Advance[Rest]]:
        """Frames ``first`` to ``last``, from ``rest`` at the frame before (frame 0: unloaded).

        ``activation(i)`` is the field of frame i, shape ``(quadrature point,)``, kPa; it is linear in
        between. The result depends on nothing else, so that a run may stop after any frame.

        Raises
        ------
        UnsolvedStepError
            If an interval fails in spite of halving; the frames before it have been yielded.
        """
        steps = HalvedSteps(self._guesses, self._solve, self.max_halvings)
        old = np.asarray(activation(first - 1)) if first else np.zeros(self.shell.points)
        for index in range(first, last + 1):
            new = np.asarray(activation(index))
            start = max(index - 1, 0) * self.step
            result = steps.advance(rest, TimeStep(index, start, self.step, old, new))
            yield result
            rest, old = result.state, new

    def unstable_directions(self, response: ShellResponse) -> int:
        """Negative pivots of the supported tangent."""
        return negative_pivots(self.shell.tangent(response).supported(self.fixed))

    def _guesses(self, rest: Rest, part: TimeStep) -> Iterator[Array]:
        onward = rest.displacement + part.length * rest.rate
        yield onward
        if not np.array_equal(onward, rest.displacement):
            yield rest.displacement

    def _solve(self, rest: Rest, part: TimeStep, guess: Array) -> tuple[Rest, int]:
        solution = newton(
            lambda u: _linearise(self.shell, self.fixed, u, part.new), guess, self.controls
        )
        rate = (solution.x - rest.displacement) / part.length
        return Rest(solution.x, rate), solution.iterations


def _linearise(shell: Shell, fixed: Fixed, displacement: Array, activation: Array) -> Linearisation:
    """R = F_int and K = K_int under an activation."""
    response = shell.respond(displacement, activation)
    residual = response.force.copy()
    residual[fixed] = 0.0
    tangent = shell.tangent(response)
    stiffness = float(np.abs(tangent.diagonal).max())
    return Linearisation(
        residual, lambda b: tangent.supported(fixed).factorise().solve(b), stiffness
    )
