"""Equilibria of a body while everything that acts on it grows from nothing, as a list of fractions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from stages.mechanics.body.body import Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.statics.equilibrium import QuasiStatics
from stages.numerics.bsplines import Array
from stages.numerics.newton import NewtonControls
from stages.numerics.stepping import Attempt, ignore


@dataclass(frozen=True)
class Equilibrium:
    """Equilibrium at one fraction of what acts; ``slope`` is d(displacement)/d(fraction)."""

    factor: float
    displacement: Array
    slope: Array


@dataclass(frozen=True)
class Increment:
    """A fraction reached: ``iterations`` since the last one, and the smallest step on the way."""

    state: Equilibrium
    iterations: int
    smallest_step: float


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
        Number of fractions.
    controls
        Newton's tolerances.
    max_halvings
        How often an increment may be halved.
    initial_increment
        First step, relative to an increment.
    listen
        Told of every attempt.
    """

    body: Body
    target: Imposed
    increments: int
    controls: NewtonControls
    max_halvings: int
    initial_increment: float = 1.0
    listen: Callable[[Attempt], None] = field(default=ignore)

    def follow(self) -> Iterator[Increment]:
        """Equilibria at 1/n, 2/n, ..., 1; each is yielded before the next one is sought.

        Raises
        ------
        UnreachedShapeError
            If one cannot be reached; those before it have been yielded.
        """
        statics = QuasiStatics(
            self.body,
            self.controls,
            1.0 / self.increments,
            self.max_halvings,
            self.initial_increment,
        )
        nothing = self.body.nothing()

        def imposed(index: int) -> Imposed:
            return nothing.towards(self.target, index / self.increments)

        shapes = statics.run(imposed, statics.unloaded(), 1, self.increments, self.listen)
        for index, shape in enumerate(shapes, start=1):
            rest = shape.state
            state = Equilibrium(index / self.increments, rest.displacement, rest.rate)
            yield Increment(state, shape.iterations, shape.smallest_step)
