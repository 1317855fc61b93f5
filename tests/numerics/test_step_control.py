"""Steps of controlled error: ends hit exactly, repeated steps, limits, and a run cut in two."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stages.numerics.integration import Integrator, Travel
from stages.numerics.newton import DivergenceError, Iteration
from stages.numerics.step_control import (
    Control,
    ControlledSteps,
    Controller,
    StepTooSmallError,
)
from stages.numerics.time_stepping import GeneralizedAlpha, Motion
from tests.numerics.moving_bodies import CONTROLS, RADII, System, begin


@dataclass(frozen=True)
class Interval:
    """A stretch of time."""

    start: float
    end: float

    remedy = "ask for less"

    @property
    def length(self) -> float:
        return self.end - self.start

    @property
    def place(self) -> str:
        return f"t = {self.start:g}"

    @property
    def extent(self) -> str:
        return f"{self.length:g} s"

    def part(self, start: float, end: float) -> Interval:
        ends = ((1.0 - w) * self.start + w * self.end for w in (start, end))
        return Interval(*ends)


def walker(
    error: float, fails_above: float = math.inf, max_parts: int = 1000
) -> ControlledSteps[tuple[float, ...], Interval]:
    """Remembers where it trod; the error of a step is ``error`` times its length cubed."""

    def solve(trodden: tuple[float, ...], part: Interval) -> tuple[tuple[float, ...], int, float]:
        assert part.start == pytest.approx(trodden[-1] if trodden else 0.0, rel=1e-15)
        if part.length > fails_above:
            raise DivergenceError(2 * (Iteration(1.0, 1.0, 1.0, 1.0),))
        return (*trodden, part.end), 3, error * part.length**3

    return ControlledSteps(solve, Controller(), max_parts)


def test_lengths_settle_where_the_error_is_just_below_its_tolerance() -> None:
    """Error (10 h)^3: the longest step is 0.1, and the safety factor settles a little below."""
    passage = walker(1000.0).advance((), Control(1.0), Interval(0.0, 10.0))
    lengths = np.diff((0.0, *passage.state))
    assert passage.state[-1] == 10.0
    assert passage.steps == len(passage.state)
    assert passage.repeated <= 3  # on the way from 1 to 0.1
    late = lengths[len(lengths) // 2 :]
    assert np.all(late > 0.07)
    assert np.all(late <= 0.1)
    assert passage.iterations == 3 * (passage.steps + passage.repeated)


def test_the_end_is_hit_exactly_with_equal_steps() -> None:
    passage = walker(1e-9).advance((0.3 * 3,), Control(0.4), Interval(0.3 * 3, 1.7))
    assert passage.state[-1] == 1.7
    steps = walker(0.0).advance((), Control(0.3), Interval(0.0, 0.8))
    # 0.8 / 0.3 asks for three; after the first one the controller allows steps of 0.4, of which the
    # rest needs two
    np.testing.assert_allclose(steps.state, [0.8 / 3, 1.6 / 3, 0.8], rtol=1e-15)


def test_a_step_without_solution_is_repeated_with_a_shorter_one() -> None:
    passage = walker(0.0, fails_above=0.3).advance((), Control(1.0), Interval(0.0, 1.0))
    assert np.diff((0.0, *passage.state)).max() <= 0.3
    assert passage.repeated >= 1
    assert passage.iterations == 3 * passage.steps + 2 * passage.repeated


@pytest.mark.parametrize(
    ("steps", "cause"),
    [
        (walker(1e30, max_parts=100), "the local error is"),
        (walker(0.0, fails_above=1e-6, max_parts=100), "Newton's method diverged"),
    ],
)
def test_a_step_that_would_have_to_be_too_short_ends_the_run(
    steps: ControlledSteps[tuple[float, ...], Interval], cause: str
) -> None:
    with pytest.raises(StepTooSmallError, match=r"not even 0\.0\d+ s: " + cause) as failure:
        steps.advance((), Control(1.0), Interval(0.0, 1.0))
    assert (failure.value.place, failure.value.remedy) == ("t = 0", "ask for less")


def test_a_shorter_interval_than_the_controller_allows_does_not_hold_it_back() -> None:
    control, longest = Control(0.1), 0.1
    for i in range(20):
        passage = walker(1.0).advance((), control, Interval(0.0, 0.1))
        control, longest = passage.control, max(longest, passage.control.length)
        assert passage.steps == 1, i
    # twice the interval, which the next step may have, times the bound of the growth
    assert 0.15 < longest <= 0.3 * (1 + 1e-12)


def test_lengths_that_do_not_divide_the_interval_are_grown_into() -> None:
    """From four steps to three takes a growth of 4/3, and more than one step's credit."""
    control = Control(0.25, 0.04)
    for _ in range(6):
        passage = walker(0.04 / 0.25**3).advance((0.0,), control, Interval(0.0, 1.0))
        control = passage.control
    assert passage.steps == 2  # of 0.5, with error 0.32


PENDULUM = System.oscillator(2.0, 0.05, cubic=3.0, load=lambda t: math.sin(3.0 * t))
START = Motion(np.array([1.0]), np.zeros(1), PENDULUM.acceleration(np.ones(1), np.zeros(1), 0.0))


def exact(times: np.ndarray) -> np.ndarray:
    """By an explicit Runge-Kutta method of order 8."""

    def rates(t: float, state: np.ndarray) -> np.ndarray:
        u, v = state[:1], state[1:]
        return np.concatenate((v, PENDULUM.acceleration(u, v, t)))

    solution = solve_ivp(
        rates, (0.0, times[-1]), [1.0, 0.0], "DOP853", times, rtol=1e-12, atol=1e-13
    )
    return np.asarray(solution.y[0])


def controlled(radius: float, tolerance: float) -> ControlledSteps[Travel, Interval]:
    integrator = Integrator(GeneralizedAlpha.damping_to(radius), CONTROLS, shifts=True)

    def solve(state: Travel, part: Interval) -> tuple[Travel, int, float]:
        step = PENDULUM.over(integrator.scheme, part.start, part.length)
        found = integrator.attempt(step, state, part.length, state.motion.displacement)
        moved = integrator.accept(step, state, found)
        return moved, found.iterations, found.error / tolerance

    return ControlledSteps(solve, Controller(), 10**5)


def frames(radius: float, tolerance: float, count: int = 8) -> tuple[np.ndarray, int]:
    steps, state, control, total = (
        controlled(radius, tolerance),
        begin(PENDULUM, START),
        Control(1.0),
        0,
    )
    found = []
    for i in range(count):
        passage = steps.advance(state, control, Interval(i / 2, (i + 1) / 2))
        state, control = passage.state, passage.control
        total += passage.steps
        found.append(state.motion.displacement[0])
    return np.array(found), total


@pytest.mark.parametrize("radius", RADII)
def test_the_error_follows_the_tolerance_to_the_power_two_thirds(radius: float) -> None:
    """Lengths go with the cube root of the tolerance, and the method is of second order."""
    reference = exact(np.arange(1, 9) / 2)
    errors, counts = [], []
    for tolerance in (1e-5, 1e-6, 1e-7):
        found, steps = frames(radius, tolerance)
        errors.append(np.abs(found - reference).max())
        counts.append(steps)
    ratios = np.array(errors[:-1]) / np.array(errors[1:])
    # 10^(2/3) = 4.64 and 10^(1/3) = 2.15; steps are cut at the frames, so that both scatter
    np.testing.assert_allclose(ratios, 10 ** (2 / 3), rtol=0.25)
    np.testing.assert_allclose(np.diff(np.log10(counts)), 1 / 3, atol=0.05)


def test_a_run_cut_at_a_frame_goes_on_to_the_same_bits() -> None:
    steps = controlled(0.5, 1e-6)
    whole = steps.advance(begin(PENDULUM, START), Control(1.0), Interval(0.0, 0.5))
    again = steps.advance(whole.state, whole.control, Interval(0.5, 1.0))
    motion, balance = whole.state.motion, whole.state.balance
    copy = Travel(
        Motion(*(a.copy() for a in (motion.displacement, motion.velocity, motion.acceleration))),
        whole.state.forces,
        type(balance)(balance.acceleration.copy(), balance.slope.copy(), balance.length),
    )
    resumed = steps.advance(
        copy, Control(whole.control.length, whole.control.error), Interval(0.5, 1.0)
    )
    np.testing.assert_array_equal(
        again.state.motion.acceleration, resumed.state.motion.acceleration
    )
    assert again.control == resumed.control
