"""Steps of controlled error through an interval, whose end is hit exactly.

A step whose error is too large, or that cannot be solved, is repeated with a shorter length; a step whose error
is small makes the next one longer. The controller is a proportional-integral one (Hairer and Wanner,
"Solving Ordinary Differential Equations II", sec. IV.2): it looks at the last two errors, so that
lengths settle instead of swinging between growth and rejection.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Generic, Protocol, TypeVar

from stages.numerics.newton import NewtonError

S = TypeVar("S")
P = TypeVar("P", bound="Span")


class Span(Protocol):
    """An interval of which parts can be taken, and how an error calls it."""

    @property
    def length(self) -> float:
        """Its length."""
        ...

    @property
    def place(self) -> str:
        """Where it starts, for instance ``"step 5, t = 20 ms"``."""
        ...

    @property
    def extent(self) -> str:
        """Its length in words, for instance ``"5 ms"``."""
        ...

    @property
    def remedy(self) -> str:
        """What the user can change if it cannot be passed."""
        ...

    def part(self: P, start: float, end: float) -> P:
        """The part between two fractions of it; 0 and 1 are its own ends exactly."""
        ...


@dataclass(frozen=True)
class Control:
    """State of the controller: the length to try next, and the last accepted error over its tolerance."""

    length: float
    error: float = 1.0


@dataclass(frozen=True)
class Controller:
    """How the error of a step, relative to its tolerance, sets the length of the next.

    Attributes
    ----------
    order
        Order of the local error: 3 for a second-order method.
    safety
        Part of the ideal length that is taken.
    shrink, growth
        Bounds of the ratio of two successive lengths. Twice the length at once would leave what the
        method carries along from step to step far from settled.
    """

    order: int = 3
    safety: float = 0.9
    shrink: float = 0.2
    growth: float = 1.5

    def accepted(self, control: Control, length: float, error: float) -> Control:
        """After a step of that length with error <= 1.

        A step may be shorter than the controller wanted, to meet the end of the interval. Its error is
        scaled to the wanted length (up to twice its own), or lengths that do not divide the interval
        could never be grown into.
        """
        wanted = min(max(control.length, length), 2.0 * length)
        now = max(error * (wanted / length) ** self.order, 1e-10)
        factor = now ** (-0.7 / self.order) * control.error ** (0.4 / self.order)
        return Control(wanted * self._bounded(factor), now)

    def rejected(self, control: Control, length: float, error: float) -> Control:
        """After a step of that length with error > 1; an infinite one if it could not be solved."""
        factor = min(self.shrink if math.isinf(error) else error ** (-1.0 / self.order), 1.0)
        return Control(length * self._bounded(factor), control.error)

    def _bounded(self, factor: float) -> float:
        return min(max(self.safety * factor, self.shrink), self.growth)


@dataclass(frozen=True)
class Passage(Generic[S]):
    """An interval that was passed.

    Attributes
    ----------
    state
        State at its end.
    control
        Controller for the next interval.
    iterations
        Newton iterations, those of repeated steps included.
    steps, repeated
        Number of accepted and of repeated steps.
    """

    state: S
    control: Control
    iterations: int
    steps: int
    repeated: int


class StepTooSmallError(Exception):
    """The error stays above its tolerance, or Newton's method fails, even in the smallest steps.

    Attributes
    ----------
    place
        Where it could not go on.
    remedy
        What to try.
    """

    def __init__(self, part: Span, error: float, failure: NewtonError | None) -> None:
        self.place = part.place
        self.remedy = part.remedy
        why = f"{failure}" if failure else f"the local error is {error:.2g} times its tolerance"
        super().__init__(f"no step is small enough, not even {part.extent}: {why}")


@dataclass(frozen=True)
class ControlledSteps(Generic[S, P]):
    """Steps through an interval, each as long as its error allows.

    Parameters
    ----------
    solve
        State at the end of a part, from a state at its start; the number of Newton iterations; the
        local error over its tolerance. Raises :class:`~stages.numerics.newton.NewtonError`.
    controller
        Sets the lengths.
    max_parts
        Most equal parts of an interval that a step may be one of: bounds the length from below.
    """

    solve: Callable[[S, P], tuple[S, int, float]]
    controller: Controller
    max_parts: int

    def advance(self, state: S, control: Control, span: P) -> Passage[S]:
        """State at the end of an interval.

        What is left of the interval is divided into equal steps not longer than the controller
        allows; after each step anew. Steps have a least length, so that this ends.

        Raises
        ------
        StepTooSmallError
            If a step shorter than the interval over ``max_parts`` would be needed.
        """
        shortest = span.length / self.max_parts
        position, iterations, steps, repeated = 0.0, 0, 0, 0
        while position != 1.0:
            parts = math.ceil((1.0 - position) * span.length / control.length - 1e-9)
            end = 1.0 if parts <= 1 else position + (1.0 - position) / parts
            part, failure = span.part(position, end), None
            try:
                reached, cost, error = self.solve(state, part)
            except NewtonError as stopped:
                failure, cost, error = stopped, len(stopped.history), math.inf
            iterations += cost
            if error <= 1.0:
                steps += 1
                state, position = reached, end
                control = self.controller.accepted(control, part.length, error)
            elif part.length <= shortest:
                raise StepTooSmallError(part, error, failure) from failure
            else:
                repeated += 1
                control = self.controller.rejected(control, part.length, error)
            control = replace(control, length=max(control.length, shortest))
        return Passage(state, control, iterations, steps, repeated)
