"""One step of a moving body with all that a run wants to know of it: error, works, lengths.

The state holds everything that the next step needs, so that a run may be cut after any step and go on to
the same bits. Steps of equal length are those of :class:`~stages.numerics.time_stepping.GeneralizedAlpha`
to the last bit: error and works are computed beside them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Protocol

from stages.numerics.bsplines import Array
from stages.numerics.energy_balance import EnergyKeeper, Forces, Works, works_of_step
from stages.numerics.newton import NewtonControls
from stages.numerics.step_error import Balance, local_error
from stages.numerics.time_stepping import GeneralizedAlpha, Motion, MotionProblem


class MovingBody(MotionProblem, EnergyKeeper, Protocol):
    """The problem of one step that also knows its energies and the size of an error."""

    def size(self, error: Array) -> float:
        """Size of a displacement error, in the unit of the tolerance."""
        ...


@dataclass(frozen=True)
class Tally:
    """What the steps since the last output were like: number, shortest, largest local error."""

    steps: int = 0
    shortest: float = math.inf
    error: float = 0.0

    def with_step(self, length: float, error: float) -> Tally:
        """One step more."""
        return Tally(self.steps + 1, min(self.shortest, length), max(self.error, error))


@dataclass(frozen=True)
class Travel:
    """A motion under way.

    Attributes
    ----------
    motion, forces
        Where the body is, and the forces there.
    balance
        Balance of the last step.
    works
        Works since the start.
    tally
        Steps since the last output.
    """

    motion: Motion
    forces: Forces
    balance: Balance
    works: Works = field(default_factory=Works)
    tally: Tally = field(default_factory=Tally)

    @classmethod
    def start(cls, motion: Motion, forces: Forces) -> Travel:
        """Before the first step."""
        return cls(motion, forces, Balance.start(motion))

    def next_output(self) -> Travel:
        """The same with a new tally."""
        return replace(self, tally=Tally())


@dataclass(frozen=True)
class Attempt:
    """A step that was solved, and not yet accepted.

    Attributes
    ----------
    old, new
        Motion at its ends; ``old`` as it went into the step.
    balance
        Its balance.
    error
        Size of its local error.
    iterations
        Newton iterations.
    """

    old: Motion
    new: Motion
    balance: Balance
    error: float
    iterations: int


@dataclass(frozen=True)
class Integrator:
    """Generalized-alpha with error and works.

    Attributes
    ----------
    scheme, controls
        The method and Newton's tolerances.
    shifts
        Whether the acceleration is moved when the length changes, which keeps second order.
    """

    scheme: GeneralizedAlpha
    controls: NewtonControls
    shifts: bool

    def attempt(self, body: MovingBody, travel: Travel, length: float, guess: Array) -> Attempt:
        """Solve a step, from a guess of its displacement.

        Raises
        ------
        NewtonError
            If the step's equations could not be solved.
        """
        scheme, old = self.scheme, travel.motion
        if self.shifts:
            old = travel.balance.shifted(scheme, old, length)
        new, solution = scheme.step(body, old, length, guess, self.controls)
        balance = travel.balance.after(scheme, old, new, length)
        error = body.size(local_error(scheme, old, new, balance))
        return Attempt(old, new, balance, error, solution.iterations)

    def accept(self, body: MovingBody, travel: Travel, attempt: Attempt) -> Travel:
        """State after a step that was solved."""
        forces = body.forces(attempt.new.displacement)
        works = works_of_step(
            body,
            self.scheme,
            (travel.motion, attempt.new),
            (travel.forces, forces),
            attempt.balance,
        )
        tally = travel.tally.with_step(attempt.balance.length, attempt.error)
        return Travel(attempt.new, forces, attempt.balance, travel.works + works, tally)

    def step(self, body: MovingBody, travel: Travel, length: float, guess: Array) -> Travel:
        """State after a step, whatever its error.

        Raises
        ------
        NewtonError
            If the step's equations could not be solved.
        """
        return self.accept(body, travel, self.attempt(body, travel, length, guess))
