"""Steps that fail are halved: one loop that owns depth, wasted iterations and the error.

A step is any stretch of a path that knows its two halves. Each half starts from the state that the one
before it reached, so that the end of the step stays where it was asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

from stages.numerics.bsplines import Array
from stages.numerics.newton import NewtonError

S = TypeVar("S")
P = TypeVar("P", bound="Stretch")


class Stretch(Protocol):
    """A step, or a part of one, and how an error calls it."""

    @property
    def place(self) -> str:
        """Where it starts, for instance ``"step 5, t = 20 ms"``."""
        ...

    @property
    def extent(self) -> str:
        """How far it goes, for instance ``"5 ms"``."""
        ...

    @property
    def remedy(self) -> str:
        """What the user can change if it cannot be solved."""
        ...

    def halves(self: P) -> tuple[P, P]:
        """Its two halves in order."""
        ...


@dataclass(frozen=True)
class Advance(Generic[S]):
    """One step.

    Attributes
    ----------
    state
        State at its end.
    iterations
        Newton iterations, those of all parts and of failed attempts together.
    halvings
        Deepest halving that it took.
    """

    state: S
    iterations: int
    halvings: int


class UnsolvedStepError(Exception):
    """A step could not be solved, not even in small parts.

    Attributes
    ----------
    place
        Where it could not go on.
    history
        Iterations of the last attempt.
    remedy
        What to try.
    """

    def __init__(self, part: Stretch, depth: int, failure: NewtonError) -> None:
        self.place = part.place
        self.history = failure.history
        self.remedy = f"{failure.remedy}; or {part.remedy}"
        parts = f"even in parts of {part.extent}" if depth else f"over {part.extent} at once"
        super().__init__(f"no solution, {parts}: {failure}")


@dataclass(frozen=True)
class HalvedSteps(Generic[S, P]):
    """Steps by Newton's method, halved where it fails.

    Parameters
    ----------
    guesses
        First iterates to try over a step from a state, the best one first; at least one.
    solve
        State at the end of a step, from a state at its start and a first iterate, and the number of
        Newton iterations; raises :class:`~stages.numerics.newton.NewtonError`.
    max_halvings
        How often a step may be halved.
    """

    guesses: Callable[[S, P], Iterable[Array]]
    solve: Callable[[S, P, Array], tuple[S, int]]
    max_halvings: int

    def advance(self, state: S, step: P) -> Advance[S]:
        """State at the end of a step.

        Raises
        ------
        UnsolvedStepError
            If a part of it fails that may not be halved again.
        """
        return self._advance(state, step, 0)

    def _advance(self, state: S, part: P, depth: int) -> Advance[S]:
        wasted = 0
        for guess in self.guesses(state, part):
            try:
                reached, iterations = self.solve(state, part, guess)
            except NewtonError as error:
                failure = error
                wasted += len(error.history)
            else:
                return Advance(reached, wasted + iterations, depth)
        if depth == self.max_halvings:
            raise UnsolvedStepError(part, depth, failure) from failure
        first, second = part.halves()
        half = self._advance(state, first, depth + 1)
        whole = self._advance(half.state, second, depth + 1)
        return Advance(
            whole.state,
            wasted + half.iterations + whole.iterations,
            max(half.halvings, whole.halvings),
        )
