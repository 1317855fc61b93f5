"""What a stimulus is: a table of the configuration that says where, how strongly and when."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Annotated, TypeAlias

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import OneOf, Section, quantity, setting
from stages.time_laws.base import AnyTimeLaw

if TYPE_CHECKING:  # a configuration is read without numpy
    from stages.electrophysiology.point_cells import PointCells
    from stages.numerics.bsplines import Array

Interval: TypeAlias = tuple[float, float]


class Stimulus(Section):
    """When the cells are stimulated; a file of this folder holds one kind and names it in ``MODEL``.

    A kind adds its size and its place on the film, by lengths X and Y along the undeformed film. The
    size is multiplied by the time law, counted from the beginning of each pulse, if there is one.
    """

    kind: str
    start: float = quantity("ms", "time at which the stimulus begins", "sec. 4.3", ge=0)
    duration: float = quantity("ms", "length of the stimulus", "sec. 4.3", gt=0)
    time_law: AnyTimeLaw | None = setting(
        "course of each pulse from its beginning, by name; none: constant",
        "this project",
        default=None,
    )
    repeats: int = setting("number of pulses", "this project", ge=1, le=100_000, default=1)
    period: float | None = quantity(
        "ms",
        "time from the beginning of a pulse to that of the next",
        "this project",
        gt=0,
        default=None,
    )

    @model_validator(mode="after")
    def _pulses_follow_one_another(self) -> Stimulus:
        if self.repeats > 1 and self.period is None:
            raise PydanticCustomError(
                "train",
                "{repeats} pulses need a period: the time from one to the next, in ms",
                {"repeats": self.repeats},
            )
        if self.repeats > 1 and self.period is not None and self.period < self.duration:
            raise PydanticCustomError(
                "train",
                "pulses of {duration} ms overlap at a period of {period} ms: the period must be at least "
                "as long as a pulse",
                {"duration": f"{self.duration:g}", "period": f"{self.period:g}"},
            )
        return self

    @property
    def starts(self) -> tuple[float, ...]:
        """Beginning of each pulse, ms."""
        return tuple(self.start + i * (self.period or 0.0) for i in range(self.repeats))

    def outside_the_run(self, end: float) -> Iterator[str]:
        """What lies beyond the end of the run (ms), in words."""
        last = self.starts[-1]
        if self.start >= end:
            yield (
                f"begins at {self.start:g} ms, but the run ends at {end:g} ms: leave it out of "
                f"electrophysiology.stimuli, or raise electrophysiology.duration"
            )
        elif self.repeats > 1 and last + self.duration > end + TOLERANCE:
            fitting = (
                int((end - self.start - self.duration + TOLERANCE) // (self.period or 1.0)) + 1
            )
            yield (
                f"the last of {self.repeats} pulses lasts until {last + self.duration:g} ms, but the run "
                f"ends at {end:g} ms: set repeats to {max(fitting, 1)} at most, or raise "
                f"electrophysiology.duration"
            )

    def off_the_film(self, length: float, width: float) -> Iterator[str]:
        """What of it lies off a film of that length and width (mm), in words."""
        raise TypeError(f"{type(self).__name__} does not say where it lies")

    def on_edge(self) -> str | None:
        """The edge through which it acts; none: it acts inside."""
        return None

    def boundary(self, cells: PointCells) -> Array:
        """Flux at the points of the boundary, nF mV/ms/mm, zero elsewhere; shape ``(point,)``."""
        return cells.nowhere()

    def interior(self, cells: PointCells) -> Array:
        """Current at the points inside, nF mV/ms/mm^2, zero on the boundary; shape ``(point,)``."""
        return cells.nowhere()


TOLERANCE = 1e-9
"""ms; times nearer to one another than this are the same, so that ``n * step`` is on time."""


def check_interval(name: str, ends: Interval) -> None:
    """Refuse an interval that does not run forward."""
    low, high = ends
    if not low < high:
        raise PydanticCustomError(
            "interval",
            "{name} must run from a smaller to a larger value, not from {low} to {high} mm",
            {"name": name, "low": f"{low:g}", "high": f"{high:g}"},
        )


AnyStimulus: TypeAlias = Annotated[
    Stimulus,
    OneOf("stages.electrophysiology.stimuli", Stimulus, tag="kind", library="stimulus_library"),
]
