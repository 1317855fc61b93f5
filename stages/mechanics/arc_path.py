"""Stored shapes along a path of equilibria, followed by arc length past limit points."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from stages.mechanics.body import Body
from stages.mechanics.controls.arc_length import ArcLength
from stages.mechanics.frames import Frame
from stages.mechanics.imposed import Imposed
from stages.mechanics.loading import Loading
from stages.mechanics.loading_log import LoadingLog
from stages.mechanics.points import functions_over
from stages.mechanics.relations import COMPONENTS
from stages.numerics.branches import ArcControls, BranchPoint, Direction
from stages.numerics.bsplines import Array
from stages.numerics.continuation import Branch
from stages.numerics.critical import PathEnd, Stage, trace
from stages.numerics.newton import Iteration, NewtonControls, NewtonError
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
        remedies = [
            failure.remedy,
            "allow shorter arcs (mechanics.control.smallest_arc, mechanics.control.first_load), more "
            "iterations (mechanics.max_iterations) or a finer mesh (mechanics.elements)",
        ]
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
    """Points of the path along which ``full`` acts times a load factor.

    Parameters
    ----------
    body
        The film with its supports and loads.
    full
        What acts at the factor 1.
    control
        End of the path, and how long an arc may be.
    controls
        Newton's tolerances.
    last
        Number of the last point, if the end is not reached before.
    """

    body: Body
    full: Imposed
    control: ArcLength
    controls: NewtonControls
    last: int
    log: LoadingLog = field(default_factory=LoadingLog)

    def frames(
        self, saved: Mapping[str, Any] | None, first: int, tell: Callable[[str], None]
    ) -> Iterator[Frame]:
        """See :class:`stages.mechanics.frames.Controlled`; frame 0 is the unloaded film.

        Raises
        ------
        UnfollowedPathError
            If a point cannot be reached; those before it have been yielded.
        """

        def listen(attempt: Attempt) -> None:
            tell(f"load factor {attempt.start:.6g} to {attempt.end:.6g}: {attempt}")

        loading = Loading(self.body, self.body.nothing(), self.full)
        number, last, work = max(first - 1, 0), None, 0.0
        try:
            branch, start = Branch.begin(
                loading, np.zeros(self.body.shell.size), 0.0, self.controls, self._arcs, listen
            )
            last = start
            if saved is None:
                yield self._frame(loading, 0, Stage(start), 0.0)
            else:
                last, work = _unpacked(saved), float(saved["work"])
                self.log = LoadingLog.restored(saved)
            if saved is not None and bool(saved["ended"]):
                return
            for found in trace(branch, last, self._end(), self.last - number):
                number += 1
                before, after = loading.imposed(last.load), loading.imposed(found.point.load)
                work += self.body.work_between(last.x, before, found.point.x, after)
                last = found.point
                yield self._frame(loading, number, found, work)
        except NewtonError as failure:
            load = 0.0 if last is None else last.load
            raise UnfollowedPathError(number + 1, load, failure) from failure

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

    def _frame(self, loading: Loading, number: int, found: Stage, work: float) -> Frame:
        point = found.point
        balance = self.body.balance(point.x, loading.imposed(point.load))
        warnings = list(self.log.look_at_point(number, point.load, balance, found.passed))
        if number == self.last and not found.ended:
            warnings.append(
                f"the path is not at its end after {number} points, but at the load factor "
                f"{point.load:.6g}: allow more points (mechanics.n_steps) or longer arcs "
                f"(mechanics.control.first_load, mechanics.control.largest_arc)"
            )
        state = {**_packed(point), "work": work, "ended": found.ended, **self.log.saved()}
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
