"""Quasi-static equilibrium under a growing activation, by load increments (eqs. 45, 52)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.shell import Shell
from stages.mechanics.supports import Fixed
from stages.numerics.bsplines import Array
from stages.numerics.halving import Advance, HalvedSteps
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
        solution = newton(lambda u: self._linearise(u, part.end), guess, self.controls)
        slope = (solution.x - last.displacement) / part.width
        return Equilibrium(part.end, solution.x, slope), solution.iterations

    def _linearise(self, displacement: Array, factor: float) -> Linearisation:
        """R = F_int and K = K_int at a fraction of the activation."""
        response = self.shell.respond(displacement, factor * self.activation)
        residual = response.force.copy()
        residual[self.fixed] = 0.0
        tangent = self.shell.tangent(response)
        stiffness = float(np.abs(tangent.diagonal).max())
        return Linearisation(
            residual, lambda b: tangent.supported(self.fixed).factorise().solve(b), stiffness
        )
