"""Steps that fail are halved in order, count what they cost, and name the part that defeats them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest

from stages.numerics.bsplines import Array
from stages.numerics.halving import HalvedSteps, UnsolvedStepError
from stages.numerics.newton import DivergenceError, Iteration

TWO_ITERATIONS = 2 * (Iteration(1.0, 1.0, 1.0, 1.0),)
GUESSES = np.zeros(1), np.ones(1)


@dataclass(frozen=True)
class Stride:
    """A stretch of the number line."""

    start: float
    end: float

    remedy = "walk slowly"

    @property
    def place(self) -> str:
        return f"x = {self.start:g}"

    @property
    def extent(self) -> str:
        return f"{self.end - self.start:g} m"

    def halves(self) -> tuple[Stride, Stride]:
        middle = 0.5 * (self.start + self.end)
        return Stride(self.start, middle), Stride(middle, self.end)


def walker(longest: float, max_halvings: int = 4) -> HalvedSteps[tuple[float, ...], Stride]:
    """Remembers where it trod; a stride beyond ``longest`` (half of it from x = 4 on) fails in two iterations."""

    def guesses(trodden: tuple[float, ...], part: Stride) -> Iterator[Array]:
        yield from GUESSES

    def solve(
        trodden: tuple[float, ...], part: Stride, guess: Array
    ) -> tuple[tuple[float, ...], int]:
        assert part.start == (trodden[-1] if trodden else 0.0)
        limit = longest if part.start < 4.0 else 0.5 * longest
        if part.end - part.start > limit or guess is GUESSES[0]:
            raise DivergenceError(TWO_ITERATIONS)
        return (*trodden, part.end), 3

    return HalvedSteps(guesses, solve, max_halvings)


def test_a_step_that_succeeds_is_not_halved_and_counts_its_failed_first_guess() -> None:
    step = walker(longest=8.0).advance((), Stride(0.0, 4.0))
    assert (step.state, step.halvings) == ((4.0,), 0)
    assert step.iterations == 2 + 3


def test_only_the_part_that_fails_is_halved_again() -> None:
    step = walker(longest=4.0).advance((), Stride(0.0, 8.0))
    assert step.state == (4.0, 6.0, 8.0)  # 0-8 fails, 0-4 is fine, 4-8 fails
    assert step.halvings == 2


def test_the_parts_and_their_failures_are_all_counted() -> None:
    step = walker(longest=2.0).advance((), Stride(0.0, 4.0))
    assert step.state == (2.0, 4.0)
    # two failed guesses of the whole, then in each half one failed guess and three iterations
    assert step.iterations == 2 * 2 + 2 * (2 + 3)


def test_a_part_that_may_not_be_halved_again_ends_the_step() -> None:
    with pytest.raises(UnsolvedStepError, match=r"^no solution, even in parts of 1 m: ") as failure:
        walker(longest=1.0, max_halvings=3).advance((), Stride(0.0, 8.0))
    assert failure.value.place == "x = 4"  # from there the limit is 0.5 m
    assert failure.value.history == TWO_ITERATIONS
    assert failure.value.remedy.endswith("; or walk slowly")
    assert isinstance(failure.value.__cause__, DivergenceError)


def test_a_step_that_may_not_be_halved_at_all_says_so() -> None:
    with pytest.raises(UnsolvedStepError, match="over 8 m at once"):
        walker(longest=1.0, max_halvings=0).advance((), Stride(0.0, 8.0))
