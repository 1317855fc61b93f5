"""Load paths: what is followed, a point of it, and how long a step may be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from stages.numerics.bsplines import Array
from stages.numerics.stepping import PathProblem


class LoadedProblem(PathProblem, Protocol):
    """Equations with a load that is sought as well."""

    def rate(self, x: Array, s: float) -> Array:
        """dR/dload; zero where the unknown is prescribed."""
        ...


@dataclass(frozen=True)
class Direction:
    """Rates of the unknowns and of the load along a path, or the normal of a plane across it."""

    x: Array
    load: float


@dataclass(frozen=True)
class BranchPoint:
    """A solution on a load path.

    Attributes
    ----------
    load, x
        Load and unknowns.
    tangent
        d(x, load)/d(arc), of unit length in the path's norm.
    arc
        Length of the path up to here, in that norm.
    step
        Arc that the next step should have.
    iterations
        Newton iterations since the last point, those of failed attempts included.
    unstable_directions
        Negative eigenvalues of the tangent stiffness, where they can be counted.
    """

    load: float
    x: Array
    tangent: Direction
    arc: float
    step: float
    iterations: int
    unstable_directions: int | None


@dataclass(frozen=True)
class ArcControls:
    """How long an arc may be.

    Attributes
    ----------
    initial_load
        Load of the first step, with its sign; also the unit of loads.
    smallest, largest
        Limits of the arc, relative to the first one.
    wanted_iterations
        Iterations of a step that is just right.
    max_turn
        Largest angle between the tangents at both ends of a step, in degrees. A sharper turn is taken
        in smaller steps; so is a step that returns to the path further away than an even turn by that
        angle would, since it has jumped a loop of the path.
    """

    initial_load: float
    smallest: float = 1e-4
    largest: float = 30.0
    wanted_iterations: int = 6
    max_turn: float = 40.0
