"""From frame to frame in time: steps that are halved where they fail, or that follow their error."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from stages.mechanics.body.imposed import Imposed
from stages.mechanics.dynamics.dynamics import LoadedShell, ShellDynamics
from stages.mechanics.dynamics.time_step import TimeStep
from stages.numerics.bsplines import Array
from stages.numerics.halving import HalvedSteps
from stages.numerics.integration import Attempt, Integrator, Travel
from stages.numerics.newton import NewtonError
from stages.numerics.step_control import Control, ControlledSteps, Controller

CONTROLLER = Controller()


@dataclass(frozen=True)
class Arrival:
    """A frame that was reached.

    Attributes
    ----------
    travel, control
        What the next frame starts from.
    iterations
        Newton iterations since the last frame, those of failed and repeated steps included.
    halvings
        Deepest halving that was taken; 0 where steps follow their error.
    """

    travel: Travel
    control: Control
    iterations: int
    halvings: int

    def __str__(self) -> str:
        """How it was reached, on one line."""
        tally = self.travel.tally
        steps = f"{tally.steps} steps, the shortest {tally.shortest:.3g} ms, "
        return (
            f"{steps if tally.steps > 1 else ''}{self.iterations} iterations, "
            f"local error {tally.error:.1e}"
        )


@dataclass(frozen=True)
class TimeLoop:
    """Frames at equal intervals, each hit exactly.

    Parameters
    ----------
    dynamics, integrator
        What moves, and how.
    step
        Time between frames, ms.
    max_halvings
        Steps as long as that: how often one that fails may be halved.
    tolerance
        None: such steps. A number: steps that follow their error, which this bounds (largest
        displacement component per step, relative to the film's diagonal).
    max_substeps
        Steps that follow their error: how small a part of ``step`` they may be.
    """

    dynamics: ShellDynamics
    integrator: Integrator
    step: float
    max_halvings: int
    tolerance: float | None
    max_substeps: int

    def run(
        self,
        imposed: Callable[[int], Imposed],
        travel: Travel,
        first: int,
        last: int,
        control: Control | None = None,
    ) -> Iterator[Arrival]:
        """Frames ``first + 1`` to ``last``, from the state at frame ``first``.

        ``imposed(i)`` is what acts at time i dt. The result depends on nothing else, so that a run may
        stop after any frame and go on later.

        Raises
        ------
        UnsolvedStepError, StepTooSmallError
            If a step fails in spite of being shortened; the frames before it have been yielded.
        """
        advance = self._halved if self.tolerance is None else self._controlled
        control = control or Control(self.step)
        old = imposed(first)
        for index in range(first + 1, last + 1):
            new = imposed(index)
            step = TimeStep(index, (index - 1) * self.step, self.step, old, new)
            arrival = advance(travel.next_output(), control, step)
            yield arrival
            travel, control, old = arrival.travel, arrival.control, new

    def _halved(self, travel: Travel, control: Control, step: TimeStep) -> Arrival:
        steps = HalvedSteps(self._guesses, self._solve, self.max_halvings)
        result = steps.advance(travel, step)
        return Arrival(result.state, control, result.iterations, result.halvings)

    def _guesses(self, travel: Travel, step: TimeStep) -> Iterator[Array]:
        """Displacements to start from.

        To go on at the old velocity takes 3 to 5 iterations. A film that stops or turns within one step
        overshoots and is stretched by that; to stay where it was takes 4 to 7, and rarely fails.
        """
        motion = travel.motion
        onward = motion.displacement + step.length * motion.velocity
        yield onward
        if not np.array_equal(onward, motion.displacement):
            yield motion.displacement

    def _solve(self, travel: Travel, step: TimeStep, guess: Array) -> tuple[Travel, int]:
        body = self._body(step)
        attempt = self.integrator.attempt(body, travel, step.length, guess)
        return self.integrator.accept(body, travel, attempt), attempt.iterations

    def _controlled(self, travel: Travel, control: Control, step: TimeStep) -> Arrival:
        assert self.tolerance is not None
        remedy = (
            "raise mechanics.error_tolerance, mechanics.n_steps or mechanics.max_substeps; a stress "
            "that jumps asks for ever shorter steps: let it rise"
        )
        whole = TimeStep(step.number, step.start, step.length, step.old, step.new, remedy)
        steps = ControlledSteps(self._solve_within, CONTROLLER, self.max_substeps)
        passage = steps.advance(travel, control, whole)
        return Arrival(passage.state, passage.control, passage.iterations, 0)

    def _solve_within(self, travel: Travel, step: TimeStep) -> tuple[Travel, int, float]:
        """The step if its error is within the tolerance; the old state otherwise."""
        assert self.tolerance is not None
        body = self._body(step)
        attempt, wasted = self._attempt(body, travel, step)
        error = attempt.error / self.tolerance
        if error <= 1.0:
            travel = self.integrator.accept(body, travel, attempt)
        return travel, wasted + attempt.iterations, error

    def _attempt(self, body: LoadedShell, travel: Travel, step: TimeStep) -> tuple[Attempt, int]:
        """From the motion that the last two balances foretell; a fast mode may spoil it."""
        motion, slope, beta = travel.motion, travel.balance.slope, self.integrator.scheme.beta
        push = 0.5 * motion.acceleration + beta * step.length * slope
        onward = motion.displacement + step.length * (motion.velocity + step.length * push)
        try:
            return self.integrator.attempt(body, travel, step.length, onward), 0
        except NewtonError as error:
            stay = motion.displacement
            return self.integrator.attempt(body, travel, step.length, stay), len(error.history)

    def _body(self, step: TimeStep) -> LoadedShell:
        return self.dynamics.between(step.old, step.new, self.integrator.scheme.alpha_f)
