"""The time between two frames, and parts of it, with what acts in them."""

from __future__ import annotations

from dataclasses import dataclass

from stages.mechanics.body.imposed import Imposed


@dataclass(frozen=True)
class TimeStep:
    """An output step or a part of one, with what acts at both of its ends.

    Attributes
    ----------
    number
        Number of the output step.
    start, length
        In ms.
    old, new
        What acts at its start and at its end; linear in between.
    remedy
        What the user can change if it cannot be solved.
    """

    number: int
    start: float
    length: float
    old: Imposed
    new: Imposed

    remedy: str = "raise mechanics.n_steps, mechanics.max_halvings or mechanics.max_iterations"

    @property
    def place(self) -> str:
        """Output step and time at its start."""
        return f"step {self.number}, t = {self.start:g} ms"

    @property
    def extent(self) -> str:
        """Its length."""
        return f"{self.length:g} ms"

    def halves(self) -> tuple[TimeStep, TimeStep]:
        """Two steps of half the length."""
        half, middle = 0.5 * self.length, self.old.towards(self.new, 0.5)
        return (
            TimeStep(self.number, self.start, half, self.old, middle, self.remedy),
            TimeStep(self.number, self.start + half, half, middle, self.new, self.remedy),
        )

    def part(self, start: float, end: float) -> TimeStep:
        """The part between two fractions of it."""
        return TimeStep(
            self.number,
            self.start + start * self.length,
            (end - start) * self.length,
            self.old if start == 0.0 else self.old.towards(self.new, start),
            self.new if end == 1.0 else self.old.towards(self.new, end),
            self.remedy,
        )
