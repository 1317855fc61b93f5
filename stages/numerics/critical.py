"""Critical points of a load path: limit points and bifurcations found, located and left by a branch.

The number of negative eigenvalues of the tangent stiffness changes where the path passes a critical point.
At a limit point the load rate changes sign with one of them; all other changes are bifurcations.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from stages.numerics.branches import BranchPoint, Direction
from stages.numerics.bsplines import Array
from stages.numerics.continuation import Branch
from stages.numerics.newton import NewtonError

Kind = Literal["limit point", "bifurcation"]

LOCATED = 1e-4
"""Part of a step within which a bifurcation is located."""

LEVEL = 1e-4
"""Load rate at a located limit point, relative to that at the ends of its step."""


@dataclass(frozen=True)
class Critical:
    """A critical point between two points of a path; ``point`` is the closest one found."""

    kind: Kind
    point: BranchPoint


@dataclass(frozen=True)
class PathEnd:
    """Where to stop: at a load, or where a weighted sum of unknowns has a value; the path ends there.

    ``weights`` None stands for the load.
    """

    value: float
    weights: Array | None = None

    @classmethod
    def at_unknown(cls, value: float, unknown: int, size: int) -> PathEnd:
        """Where one of ``size`` unknowns has a value."""
        weights = np.zeros(size)
        weights[unknown] = 1.0
        return cls(value, weights)

    def of(self, point: BranchPoint) -> float:
        """What is compared with ``value``."""
        return point.load if self.weights is None else float(self.weights @ point.x)

    def between(self, before: BranchPoint, after: BranchPoint) -> bool:
        """Whether the path crosses the end on the way from one point to the next."""
        a, b = self.of(before) - self.value, self.of(after) - self.value
        return a != 0.0 and a * b <= 0.0

    def reach(self, branch: Branch, before: BranchPoint, after: BranchPoint) -> BranchPoint:
        """The point at the end itself."""
        if self.weights is None:
            return branch.at_load(before, after, self.value)
        return branch.at_value(before, after, self.weights, self.value)


@dataclass(frozen=True)
class Stage:
    """A point of a traced path, with what was passed on the way to it, and whether it is the end."""

    point: BranchPoint
    passed: tuple[Critical, ...] = ()
    ended: bool = False


def trace(
    branch: Branch, start: BranchPoint, end: PathEnd, max_points: int, *, located: bool = True
) -> Iterator[Stage]:
    """Points of the path from ``start`` to its end, each yielded before the next one is sought.

    Parameters
    ----------
    branch, start
        The path and a point of it.
    end
        Where to stop; the last point lies there, up to rounding.
    max_points
        Points after which to stop in any case; the last one then is not ``ended``.
    located
        Whether critical points are located, or told as the nearer of the two points around them.

    Raises
    ------
    NewtonError
        If the path cannot be followed; its points so far have been yielded.
    """
    last = start
    for _ in range(max_points):
        point = branch.advance(last)
        ended = end.between(last, point)
        if ended:
            reached = end.reach(branch, last, point)
            point = replace(reached, iterations=reached.iterations + point.iterations)
        yield Stage(point, tuple(_passed(branch, last, point, located)), ended)
        if ended:
            return
        last = point


def kinds(before: BranchPoint, after: BranchPoint) -> tuple[Kind, ...]:
    """Critical points that lie between two successive points of a path."""
    turned = before.tangent.load * after.tangent.load < 0.0
    if before.unstable_directions is None or after.unstable_directions is None:
        return ("limit point",) if turned else ()
    change = abs(after.unstable_directions - before.unstable_directions)
    others = abs(change - 1) if turned else change
    limit: tuple[Kind, ...] = ("limit point",) if turned else ()
    return (*limit, *(("bifurcation",) if others else ()))


def _passed(
    branch: Branch, before: BranchPoint, after: BranchPoint, located: bool
) -> Iterator[Critical]:
    for kind in kinds(before, after):
        nearer = min(before, after, key=lambda p: abs(p.tangent.load))
        if located:
            try:
                find = locate_limit if kind == "limit point" else locate_bifurcation
                nearer = find(branch, before, after)
            except NewtonError:
                pass  # the nearer of the two points has to do
        yield Critical(kind, nearer)


def locate_limit(branch: Branch, before: BranchPoint, after: BranchPoint) -> BranchPoint:
    """The limit point between two points, by the Illinois method on the load rate."""
    a, b = before, after
    rate_a, rate_b = a.tangent.load, b.tangent.load
    level = LEVEL * max(abs(rate_a), abs(rate_b))
    best = min(a, b, key=lambda p: abs(p.tangent.load))
    for _ in range(20):
        point = branch.between(a, b, rate_a / (rate_a - rate_b))
        rate = point.tangent.load
        best = min(best, point, key=lambda p: abs(p.tangent.load))
        if abs(rate) <= level:
            break
        if rate * rate_b > 0.0:
            b, rate_b, rate_a = point, rate, 0.5 * rate_a
        else:
            a, rate_a, rate_b = point, rate, 0.5 * rate_b
    return best


def locate_bifurcation(branch: Branch, before: BranchPoint, after: BranchPoint) -> BranchPoint:
    """The last point found before the number of unstable directions changes, by bisection."""
    a, b, width = before, after, 1.0
    while width > LOCATED:
        middle = branch.between(a, b, 0.5)
        if middle.unstable_directions == before.unstable_directions:
            a = middle
        else:
            b = middle
        width *= 0.5
    return a


def critical_direction(branch: Branch, point: BranchPoint) -> Array:
    """Unit eigenvector of the tangent stiffness next to zero, by inverse iteration."""
    problem, random = branch.problem, np.random.default_rng(0)
    rough = point.x + random.normal(size=point.x.size)
    vector = problem.admissible(rough, point.load) - problem.admissible(point.x, point.load)
    system = problem.linearise(point.x, point.load)
    for _ in range(8):
        vector = system.solve(vector / np.linalg.norm(vector))
    vector /= np.linalg.norm(vector)
    # a sign that does not depend on round-off in the iteration
    return np.asarray(vector * np.sign(vector[np.argmax(np.abs(vector))]))


def switch_branch(branch: Branch, point: BranchPoint, amplitude: float) -> BranchPoint:
    """First point of the branch that crosses at a simple bifurcation.

    The critical direction is imposed with an amplitude, in the unit of the path's norm and with either
    sign, while the load adjusts itself: the old branch does not have that component.

    Raises
    ------
    NewtonError
        If no other branch is found at that amplitude.
    """
    direction = critical_direction(branch, point)
    guess = replace(
        point,
        x=point.x + amplitude * branch.unit * direction,
        tangent=Direction(np.sign(amplitude) * direction, 0.0),
        step=abs(amplitude),
    )
    return branch.correct(guess, Direction(direction, 0.0))
