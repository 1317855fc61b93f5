"""Pseudo-arclength continuation of R(x, load) = 0 past limit points, turning points and bifurcations.

Keller's method. At a point of the path K z = -dR/dload gives the tangent (z, 1), scaled to length one in
the norm |(x, load)|^2 = |x|^2/c^2 + load^2/l^2 and oriented by its product with the last one, so that
the path never doubles back. A step goes along the tangent by an arc and returns to the path within the
plane across it; the bordered system takes two solves with K. As lengths, l is the load of the first step
and c the motion that it causes: the arc counts both alike until the structure softens, and then the
motion alone.

References
----------
Keller (1977), in Applications of Bifurcation Theory, 359-384; Crisfield (1991), Non-linear Finite
Element Analysis of Solids and Structures, vol. 1, chapter 9.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from stages.numerics.branches import ArcControls, BranchPoint, Direction, LoadedProblem
from stages.numerics.bsplines import Array
from stages.numerics.newton import (
    Linearisation,
    NewtonControls,
    NewtonError,
    SingularTangentError,
    newton,
)
from stages.numerics.sparse import SingularMatrixError
from stages.numerics.stepping import Attempt, ignore


@dataclass(frozen=True)
class Branch:
    """The path through a starting point, with its norm.

    Parameters
    ----------
    problem
        The equations.
    controls
        Newton's tolerances.
    arcs
        How long an arc may be.
    unit
        The motion that counts as much as ``arcs.initial_load``.
    listen
        Told of every attempt.
    """

    problem: LoadedProblem
    controls: NewtonControls
    arcs: ArcControls
    unit: float
    listen: Callable[[Attempt], None] = ignore

    @classmethod
    def begin(
        cls,
        problem: LoadedProblem,
        x: Array,
        load: float,
        controls: NewtonControls,
        arcs: ArcControls,
        listen: Callable[[Attempt], None] = ignore,
    ) -> tuple[Branch, BranchPoint]:
        """The branch through a known solution, and its first point, headed for growing |load|.

        Raises
        ------
        SingularTangentError
            If the tangent there is singular: the body is not held, or the point is critical.
        """
        system = problem.linearise(x, load)
        try:
            z = system.solve(-problem.rate(x, load))
        except SingularMatrixError as error:
            raise SingularTangentError((), f" where the path starts: {error}") from None
        size = float(np.linalg.norm(z)) * abs(arcs.initial_load)
        branch = cls(problem, controls, arcs, size or controls.length, listen)
        tangent = branch._unit(Direction(z, 1.0), np.sign(arcs.initial_load))
        first = abs(arcs.initial_load / (tangent.load or 1.0))
        return branch, BranchPoint(load, x, tangent, 0.0, first, 0, system.unstable_directions)

    @property
    def first_arc(self) -> float:
        """Arc of the first step: the load unit and the motion it causes, each of length one."""
        return float(np.sqrt(2.0))

    def dot(self, a: Direction, b: Direction) -> float:
        """Inner product of the path's norm."""
        load = a.load * b.load / self.arcs.initial_load**2
        return float(a.x @ b.x) / self.unit**2 + load

    def advance(self, last: BranchPoint) -> BranchPoint:
        """Next point of the path.

        Raises
        ------
        NewtonError
            If even the smallest arc fails.
        """
        arc = min(last.step, self.arcs.largest * self.first_arc)
        smallest = self.arcs.smallest * self.first_arc
        wasted = 0
        while True:
            try:
                point = self._reach(last, arc)
                shrinkable = 0.5 * arc >= smallest
                if not shrinkable or self._smooth(last, point, arc):
                    easiness = self.arcs.wanted_iterations / max(point.iterations, 1)
                    grown = arc * (0.5 if wasted else min(2.0, max(0.5, np.sqrt(easiness))))
                    step = max(grown, arc if wasted else smallest)
                    return replace(point, step=step, iterations=wasted + point.iterations)
                wasted += point.iterations
            except NewtonError as failure:
                wasted += len(failure.history)
                if 0.5 * arc < smallest:
                    raise
            arc *= 0.5

    def _smooth(self, last: BranchPoint, point: BranchPoint, arc: float) -> bool:
        """Whether the path turns little over a step, as far as its ends can tell."""
        turn, t = np.radians(self.arcs.max_turn), last.tangent
        aside = Direction(point.x - last.x - arc * t.x, point.load - last.load - arc * t.load)
        bend = np.sqrt(self.dot(aside, aside)) / arc
        return bool(self.dot(point.tangent, t) >= np.cos(turn) and bend <= np.tan(0.5 * turn))

    def at_load(self, near: BranchPoint, other: BranchPoint, load: float) -> BranchPoint:
        """The point of exactly that load, between two points of the path."""
        fraction = (load - near.load) / (other.load - near.load)
        guess = _between(near, other, fraction)
        normal = Direction(np.zeros_like(near.x), 1.0)
        return self.correct(replace(guess, load=load), normal)

    def at_value(
        self, near: BranchPoint, other: BranchPoint, weights: Array, value: float
    ) -> BranchPoint:
        """The point where a weighted sum of unknowns has that value, between two points of the path."""
        a, b = weights @ near.x, weights @ other.x
        guess = _between(near, other, float((value - a) / (b - a)))
        x = guess.x + (value - weights @ guess.x) / (weights @ weights) * weights
        return self.correct(replace(guess, x=x), Direction(weights, 0.0))

    def between(self, near: BranchPoint, other: BranchPoint, fraction: float) -> BranchPoint:
        """The point of the path in the plane that divides the chord of two points."""
        chord = Direction(other.x - near.x, other.load - near.load)
        return self.correct(_between(near, other, fraction), self._covector(chord))

    def correct(self, guess: BranchPoint, normal: Direction) -> BranchPoint:
        """The point of the path in the plane through ``guess`` across ``normal``.

        ``guess.tangent`` orients the tangent of the result.

        Raises
        ------
        NewtonError
            If there is none nearby.
        """
        start = np.append(guess.x, guess.load / self._load_scale)
        try:
            with np.errstate(all="ignore"):  # an overshoot is found by its residual
                solution = newton(lambda y: self._bordered(y, normal), start, self.controls)
                x, load = solution.x[:-1], float(solution.x[-1]) * self._load_scale
                # a corrected unknown stays put in exact arithmetic only
                load = guess.load if not normal.x.any() else load
                tangent = self._tangent(x, load, solution.system, guess.tangent)
        except NewtonError as failure:
            self.listen(Attempt(guess.load, guess.load, failure.history, failure))
            raise
        self.listen(Attempt(guess.load, load, solution.history))
        return replace(
            guess,
            x=x,
            load=load,
            tangent=tangent,
            iterations=solution.iterations,
            unstable_directions=solution.system.unstable_directions,
        )

    def _reach(self, last: BranchPoint, arc: float) -> BranchPoint:
        """The point at an arc from the last one."""
        t = last.tangent
        load = last.load + arc * t.load
        x = self.problem.admissible(last.x + arc * t.x, load)
        guess = replace(last, x=x, load=load, arc=last.arc + arc)
        return self.correct(guess, self._covector(t))

    @property
    def _load_scale(self) -> float:
        """Load per unknown: a change of the load unit counts as one of the whole length."""
        return abs(self.arcs.initial_load) / self.controls.length

    def _covector(self, direction: Direction) -> Direction:
        """Gradient of the product with a direction."""
        return Direction(direction.x / self.unit**2, direction.load / self.arcs.initial_load**2)

    def _unit(self, direction: Direction, sign: float) -> Direction:
        factor = (sign or 1.0) / np.sqrt(self.dot(direction, direction))
        return Direction(factor * direction.x, float(factor * direction.load))

    def _tangent(self, x: Array, load: float, system: Linearisation, last: Direction) -> Direction:
        """Unit tangent that goes on in the direction of the last one."""
        try:
            z = system.solve(-self.problem.rate(x, load))
        except SingularMatrixError:
            return last  # exactly at a critical point
        direction = Direction(z, 1.0)
        return self._unit(direction, float(np.sign(self.dot(direction, last))))

    def _bordered(self, y: Array, normal: Direction) -> Linearisation:
        """R(x, load) with the load as last unknown, whose equation keeps to the plane."""
        x, load = y[:-1], float(y[-1]) * self._load_scale
        return self._border(self.problem.linearise(x, load), x, load, normal)

    def _border(
        self, system: Linearisation, x: Array, load: float, normal: Direction
    ) -> Linearisation:
        def solve(b: Array) -> Array:
            if b.shape == x.shape:  # K alone, for the tangent
                return system.solve(b)
            direct = system.solve(b[:-1])
            slope = system.solve(-self.problem.rate(x, load))
            leading = float(normal.x @ slope) + normal.load
            if leading == 0.0:
                raise SingularMatrixError("the path runs along the plane of its correction")
            change = -float(normal.x @ direct) / leading
            return np.append(direct + change * slope, change / self._load_scale)

        def ahead(correction: Array, parameter: float | None = None) -> Linearisation:
            new, reached = x + correction[:-1], load + float(correction[-1]) * self._load_scale
            if system.ahead is None:
                after = self.problem.linearise(new, reached)
            else:
                after = system.ahead(correction[:-1], reached)
            return self._border(after, new, reached, normal)

        residual = np.append(system.residual, 0.0)
        return Linearisation(residual, solve, system.stiffness, system.negative_pivots, ahead)


def _between(near: BranchPoint, other: BranchPoint, fraction: float) -> BranchPoint:
    """Linear interpolation; the tangent is the first point's."""
    return replace(
        near,
        x=near.x + fraction * (other.x - near.x),
        load=near.load + fraction * (other.load - near.load),
        arc=near.arc + fraction * (other.arc - near.arc),
    )
