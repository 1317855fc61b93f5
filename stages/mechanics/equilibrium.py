"""Quasi-static equilibrium under a growing activation, by load increments (eqs. 45, 52)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.shell import Shell
from stages.mechanics.supports import Fixed
from stages.numerics.bsplines import Array
from stages.numerics.newton import Linearisation, NewtonControls, NewtonError, newton


@dataclass(frozen=True)
class Increment:
    """Equilibrium at one fraction of the activation.

    Attributes
    ----------
    factor
        Fraction of the full activation.
    displacement
        Control displacements, mm, shape ``(dof,)``.
    slope
        d(displacement)/d(factor) over the increment; the next guess follows it.
    iterations
        Newton iterations, those of all partial increments together.
    halvings
        Deepest halving that it took.
    """

    factor: float
    displacement: Array
    slope: Array
    iterations: int
    halvings: int


class IncrementError(Exception):
    """A load increment could not be solved, not even in small parts.

    Attributes
    ----------
    factor
        Fraction of the activation up to which equilibria were found.
    history
        Iterations of the last attempt.
    remedy
        What to try.
    """

    def __init__(self, factor: float, part: float, failure: NewtonError) -> None:
        self.factor = factor
        self.history = failure.history
        self.remedy = f"{failure.remedy}; or use more increments"
        super().__init__(
            f"no equilibrium found beyond {factor:.4g} of the activation, even with an increment "
            f"of {part:.2g}: {failure}"
        )


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

    def follow(self) -> Iterator[Increment]:
        """Equilibria at 1/n, 2/n, ..., 1; each is yielded before the next one is sought.

        Raises
        ------
        IncrementError
            If an increment fails in spite of halving; those before it have been yielded.
        """
        zero = np.zeros(self.shell.size)
        last = Increment(0.0, zero, zero, 0, 0)
        for index in range(1, self.increments + 1):
            last = self._reach(last, index / self.increments, 0)
            yield last

    def _reach(self, last: Increment, factor: float, depth: int) -> Increment:
        width = factor - last.factor
        guess = last.displacement + width * last.slope
        try:
            solution = newton(lambda u: self._linearise(u, factor), guess, self.controls)
        except NewtonError as failure:
            if depth == self.max_halvings:
                raise IncrementError(last.factor, width, failure) from failure
            first = self._reach(last, last.factor + 0.5 * width, depth + 1)
            second = self._reach(first, factor, depth + 1)
            return Increment(
                factor,
                second.displacement,
                second.slope,
                len(failure.history) + first.iterations + second.iterations,
                max(first.halvings, second.halvings),
            )
        slope = (solution.x - last.displacement) / width
        return Increment(factor, solution.x, slope, solution.iterations, depth)

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
