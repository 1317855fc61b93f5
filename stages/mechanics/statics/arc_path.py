"""Stored shapes along a path of equilibria, followed by arc length past limit points."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stages.mechanics.actions.points import functions_over
from stages.mechanics.actions.relations import COMPONENTS
from stages.mechanics.body.body import Body
from stages.mechanics.body.imposed import Imposed
from stages.mechanics.controls.arc_length import ArcLength
from stages.mechanics.statics.equilibrium import QuasiStatics
from stages.mechanics.statics.frames import Frame
from stages.mechanics.statics.loading import Loading
from stages.mechanics.statics.loading_log import LoadingLog, unstable_directions
from stages.numerics.branches import ArcControls, BranchPoint, Direction
from stages.numerics.bsplines import Array
from stages.numerics.continuation import Branch
from stages.numerics.critical import PathEnd, Stage, trace
from stages.numerics.newton import Iteration, NewtonError, SingularTangentError
from stages.numerics.stepping import Attempt


class UnfollowedPathError(Exception):
    """A path could not be followed to its end.

    Attributes
    ----------
    place
        Point that was sought.
    history
        Iterations of the last attempt.
    remedy
        What to try, and how to have the points up to there.
    """

    def __init__(self, number: int, load: float, failure: NewtonError) -> None:
        self.history: tuple[Iteration, ...] = failure.history
        self.place = f"point {number} of the path"
        remedies = [failure.remedy] if isinstance(failure, SingularTangentError) else []
        remedies.append(
            "allow shorter arcs (mechanics.control.smallest_arc, mechanics.control.first_load), more "
            "iterations (mechanics.max_iterations) or a finer mesh (mechanics.elements)"
        )
        if number > 1:
            remedies.append(
                f"for a result with the points up to the last one reached, set mechanics.n_steps = "
                f"{number - 1}"
            )
        self.remedy = "; or ".join(remedies)
        super().__init__(
            f"the path was followed to the load factor {load:.6g}, and not even the smallest arc leads "
            f"on: {failure}"
        )


@dataclass
class ByArcLength:
    """Points of the path along which the preload acts, and what is added to it, times a load factor.

    Parameters
    ----------
    statics
        The film, and how its preload is reached by load.
    imposed
        What the time laws say of a frame.
    control
        Preload, end of the path, and how long an arc may be.
    last
        Number of the last point, if the end is not reached before; of the last frame of the loading.
    """

    statics: QuasiStatics
    imposed: Callable[[int], Imposed]
    control: ArcLength
    last: int
    log: LoadingLog = field(default_factory=LoadingLog)

    @property
    def body(self) -> Body:
        """The film with its supports and loads."""
        return self.statics.body

    @property
    def added(self) -> Imposed:
        """What the load factor multiplies."""
        return self.imposed(self.last).minus(self._preload)

    @property
    def _preload(self) -> Imposed:
        frame = round(self.control.preload / self.statics.step)
        return self.imposed(frame) if frame else self.body.nothing()

    def frames(
        self, saved: Mapping[str, Any] | None, first: int, tell: Callable[[str], None]
    ) -> Iterator[Frame]:
        """See :class:`stages.mechanics.statics.frames.Controlled`; frame 0 is the film under its preload.

        Raises
        ------
        UnreachedShapeError
            If the preload cannot be reached.
        UnfollowedPathError
            If a point cannot be reached; those before it have been yielded.
        """

        def listen(attempt: Attempt) -> None:
            tell(f"load factor {attempt.start:.6g} to {attempt.end:.6g}: {attempt}")

        loading = Loading(self.body, self._preload, self.imposed(self.last))
        if saved is None:
            origin, work = self._preloaded(tell)
        else:
            origin, work = saved["origin"], float(saved["work"])
            self.log = LoadingLog.restored(saved)
        number, load = max(first - 1, 0), 0.0
        try:
            branch, last = Branch.begin(
                loading, origin, 0.0, self.statics.controls, self._arcs, listen
            )
            if saved is None:
                yield self._frame(loading, 0, Stage(last), origin, work)
            else:
                last = _unpacked(saved)
                if saved["ended"]:
                    return
            load = last.load
            for found in trace(branch, last, self._end(), self.last - number):
                before, after = loading.imposed(last.load), loading.imposed(found.point.load)
                work += self.body.work_between(last.x, before, found.point.x, after)
                number, last, load = number + 1, found.point, found.point.load
                yield self._frame(loading, number, found, origin, work)
        except NewtonError as failure:
            raise UnfollowedPathError(number + 1, load, failure) from failure

    def _preloaded(self, tell: Callable[[str], None]) -> tuple[Array, float]:
        """Displacement under the preload, and the work that it took."""
        rest = self.statics.unloaded()
        frame = round(self.control.preload / self.statics.step)
        if not frame:
            return rest.displacement, 0.0

        def listen(attempt: Attempt) -> None:
            tell(f"preload, t = {attempt.start:.6g} to {attempt.end:.6g} ms: {attempt}")

        for shape in self.statics.run(self.imposed, rest, 0, frame, listen):
            rest = shape.state
        return rest.displacement, rest.work

    @property
    def _arcs(self) -> ArcControls:
        sign = math.copysign(1.0, self.control.last_factor or 1.0)
        return ArcControls(
            sign * self.control.first_load,
            smallest=self.control.smallest_arc,
            largest=self.control.largest_arc,
            max_turn=self.control.max_turn,
        )

    def _end(self) -> PathEnd:
        until = self.control.until
        if until is None:
            factor = self.control.last_factor
            assert factor is not None
            return PathEnd(factor)
        weights = np.zeros((self.body.shell.size // 3, 3))
        column = COMPONENTS.index(until.component)
        weights[:, column] = functions_over(self.body.shell.patch, until.position)
        return PathEnd(until.displacement, weights.ravel())

    def _frame(
        self, loading: Loading, number: int, found: Stage, origin: Array, work: float
    ) -> Frame:
        point = found.point
        balance = self.body.balance(point.x, loading.imposed(point.load))
        warnings = list(self.log.look_at_point(number, point.load, balance, found.passed))
        if number == self.last and not found.ended:
            warnings.append(
                f"the path is not at its end after {number} points, but at the load factor "
                f"{point.load:.6g}: allow more points (mechanics.n_steps) or longer arcs "
                f"(mechanics.control.first_load, mechanics.control.largest_arc)"
            )
        if number == 0 and self.log.unstable:
            warnings.append(
                f"the film under its preload is not stable ({unstable_directions(self.log.unstable)}): "
                f"a real one would have left this shape"
            )
        state = {
            **_packed(point),
            "origin": origin,
            "work": work,
            "ended": found.ended,
            **self.log.saved(),
        }
        return Frame(balance, point.load, work, point.iterations, math.nan, state, tuple(warnings))


def _packed(point: BranchPoint) -> dict[str, Array | float]:
    """A point of the path as plain arrays."""
    unstable = point.unstable_directions
    return {
        "displacement": point.x,
        "direction": point.tangent.x,
        "numbers": np.array([point.load, point.tangent.load, point.arc, point.step]),
        "counts": np.array([point.iterations, -1 if unstable is None else unstable]),
    }


def _unpacked(saved: Mapping[str, Any]) -> BranchPoint:
    """The point from what :func:`_packed` made of it."""
    load, rate, arc, step = (float(x) for x in saved["numbers"])
    iterations, unstable = (int(x) for x in saved["counts"])
    tangent = Direction(saved["direction"], rate)
    return BranchPoint(
        load,
        saved["displacement"],
        tangent,
        arc,
        step,
        iterations,
        None if unstable < 0 else unstable,
    )
