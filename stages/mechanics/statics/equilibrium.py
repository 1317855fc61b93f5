"""Quasi-static equilibrium of the film, frame by frame in adaptive load steps (eqs. 45, 52)."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.body.body import Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.statics.loading import Loading, in_words
from stages.numerics.bsplines import Array
from stages.numerics.newton import Iteration, NewtonControls, NewtonError, SingularTangentError
from stages.numerics.sparse import SingularMatrixError
from stages.numerics.stepping import (
    Attempt,
    PathEndError,
    PathPoint,
    StepControls,
    follow,
    ignore,
)


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
    step
        Load step that Newton's method is up to, ms; infinite at the start.
    """

    displacement: Array
    rate: Array
    work: float
    step: float = np.inf


@dataclass(frozen=True)
class Shape:
    """Equilibrium at a frame.

    Attributes
    ----------
    state
        The shape.
    iterations
        Newton iterations since the last frame, failed attempts included.
    smallest_step
        Shortest load step since the last frame, ms.
    """

    state: Rest
    iterations: int
    smallest_step: float


class UnreachedShapeError(Exception):
    """The film has no equilibrium nearby beyond some instant, or none was found.

    Attributes
    ----------
    place
        Frame that was wanted.
    history
        Iterations of the last attempt.
    remedy
        What to try, and how to have the shapes up to there.
    """

    def __init__(self, number: int, step: float, load: str, end: PathEndError) -> None:
        self.history: tuple[Iteration, ...] = end.history
        self.place = f"shape {number} (t = {number * step:g} ms)"
        remedies = [end.failure.remedy] if isinstance(end.failure, SingularTangentError) else []
        remedies.append(
            "allow shorter load steps (mechanics.max_halvings) or more iterations "
            "(mechanics.max_iterations)"
        )
        reached = f"{(number - 1) * step:.12g}"
        preload = f", mechanics.control.preload = {reached} or less" if number > 1 else ""
        remedies.append(
            "where the load has a maximum no step is short enough: follow the path past it by arc length "
            f"(mechanics.control.kind = arc-length{preload}), or move a support instead of loading "
            "(mechanics.supports, kind = displacement)"
        )
        if number > 1:
            remedies.append(
                f"for a result with the shapes up to the last one reached, set mechanics.n_steps = "
                f"{number - 1} and mechanics.duration = {reached}"
            )
        self.remedy = "; or ".join(remedies)
        super().__init__(
            f"equilibrium was followed to t = {end.reached.s:.6g} ms ({load}), and not even a load step of "
            f"{end.step:.2g} ms leads on: {end.failure}"
        )


@dataclass(frozen=True)
class QuasiStatics:
    """Equilibria at equal intervals of a slow loading, in as many load steps as it takes.

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
    initial_increment
        First load step, relative to the interval.
    """

    body: Body
    controls: NewtonControls
    step: float
    max_halvings: int
    initial_increment: float = 1.0

    def unloaded(self) -> Rest:
        """The film before anything acts."""
        zero = np.zeros(self.body.shell.size)
        return Rest(zero, zero, 0.0, self.initial_increment * self.step)

    def run(
        self,
        imposed: Callable[[int], Imposed],
        rest: Rest,
        first: int,
        last: int,
        listen: Callable[[Attempt], None] = ignore,
    ) -> Iterator[Shape]:
        """Frames ``first`` to ``last``, from ``rest`` at the frame before (frame 0: unloaded).

        ``imposed(i)`` is what acts in frame i; it is linear in between. The result depends on nothing
        else, so that a run may stop after any frame.

        Raises
        ------
        UnreachedShapeError
            If a frame cannot be reached; those before it have been yielded.
        """
        old = imposed(first - 1) if first else self.body.nothing()
        for index in range(first, last + 1):
            new = imposed(index)
            loading = Loading(self.body, old, new, (index - 1) * self.step, index * self.step)
            try:
                shape = self._interval(loading, rest, listen)
            except PathEndError as end:
                load = in_words(self.body, loading.imposed(end.reached.s))
                raise UnreachedShapeError(index, self.step, load, end) from end
            yield shape
            rest, old = shape.state, new

    def _interval(self, loading: Loading, rest: Rest, listen: Callable[[Attempt], None]) -> Shape:
        """The shape at the end of an interval."""
        steps = StepControls(
            initial=self.initial_increment * self.step,
            smallest=self.step / 2**self.max_halvings,
        )
        last = self._start(loading, rest)
        work, iterations = rest.work, 0
        for point in follow(loading, last, [loading.last], steps, self.controls, listen):
            work += self.body.work_between(
                last.x, loading.imposed(last.s), point.x, loading.imposed(point.s)
            )
            iterations += point.iterations
            last = point
        assert last.slope is not None
        assert last.length is not None
        return Shape(Rest(last.x, last.slope, work, last.length), iterations, last.smallest_step)

    def _start(self, loading: Loading, rest: Rest) -> PathPoint:
        """Where an interval starts; from rest, the exact direction of the path is known."""
        slope = rest.rate
        if not slope.any():
            try:
                slope = loading.direction(rest.displacement, loading.first)
            except SingularMatrixError as error:
                failure: NewtonError = SingularTangentError((), f": {error}")
                point = PathPoint(loading.first, rest.displacement)
                raise PathEndError(point, 0.0, failure) from error
        length = min(rest.step, self.step)
        return PathPoint(loading.first, rest.displacement, slope, length)
