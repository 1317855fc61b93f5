"""Configuration of the stages that pace tissue: restitution, vulnerable window."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

from pydantic import field_validator, model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import Section, quantity, setting
from stages.electrophysiology.config import ElectrophysiologyConfig
from stages.electrophysiology.stimuli.base import AnyStimulus, check_interval


class RestitutionProtocol(Section):
    """A regular train S1, then one stimulus S2, at each of several intervals (S1-S2)."""

    preparation: Literal["cell", "cable"] = setting(
        "what is paced: a cell without neighbours, or a strip of tissue", "this project"
    )
    pulses: dict[Literal["cell", "cable"], AnyStimulus] = setting(
        "pulse that paces each preparation; the protocol repeats it", "this project"
    )
    count: int = setting("number of stimuli S1", "this project", ge=1, le=10_000)
    period: float = quantity("ms", "time between stimuli S1", "this project", gt=0)
    intervals: tuple[float, ...] = quantity(
        "ms", "times from the last S1 to S2, each a case of its own", "this project"
    )
    periods: tuple[float, ...] = quantity(
        "ms", "periods of further trains, of which the last beat is measured", "this project"
    )
    tolerance: float = quantity(
        "ms", "how closely the shortest interval that activates is found", "this project", gt=0
    )
    window: tuple[float, float] = quantity(
        "mm",
        "from which X to which X a wave on the strip is timed; beats are measured next to its middle",
        "this project",
    )

    @field_validator("intervals")
    @classmethod
    def _intervals_ascend(cls, intervals: tuple[float, ...]) -> tuple[float, ...]:
        if not intervals:
            raise PydanticCustomError("no_cases", "give at least one interval")
        check_ascending(intervals)
        return intervals

    @field_validator("periods")
    @classmethod
    def _periods_ascend(cls, periods: tuple[float, ...]) -> tuple[float, ...]:
        check_ascending(periods)
        return periods

    @field_validator("window")
    @classmethod
    def _window_runs_forward(cls, window: tuple[float, float]) -> tuple[float, float]:
        check_interval("window", window)
        return window

    @model_validator(mode="after")
    def _pulses_fit(self) -> RestitutionProtocol:
        for name, pulse in self.pulses.items():
            if pulse.repeats != 1:
                raise PydanticCustomError(
                    "pulses",
                    "pulses.{name}.repeats is {repeats}, but protocol.count says how often the pulse is "
                    "repeated: leave repeats and period out",
                    {"name": name, "repeats": pulse.repeats},
                )
        if self.preparation not in self.pulses:
            raise PydanticCustomError(
                "pulses",
                "pulses.{name} is missing: say what paces the {name}",
                {"name": self.preparation},
            )
        cell = self.pulses.get("cell")
        if cell is not None and cell.kind != "uniform-current":
            raise PydanticCustomError(
                "pulses",
                "pulses.cell is of kind {kind}, but a cell has no edges and no extent: it takes a "
                "uniform-current",
                {"kind": repr(cell.kind)},
            )
        paced = {"period": (self.period,), "intervals": self.intervals, "periods": self.periods}
        for what, times in paced.items():
            shortest = min(times, default=math.inf)
            if shortest < self.pulse.duration:
                raise PydanticCustomError(
                    "pulses",
                    "pulses of {duration} ms overlap: {what} must be at least that long, not {shortest}"
                    " ms",
                    {
                        "duration": f"{self.pulse.duration:g}",
                        "what": what,
                        "shortest": f"{shortest:g}",
                    },
                )
        return self

    @property
    def pulse(self) -> AnyStimulus:
        """The pulse of the chosen preparation."""
        return self.pulses[self.preparation]

    @property
    def train(self) -> AnyStimulus:
        """All S1."""
        return self.pulse.model_copy(update={"repeats": self.count, "period": self.period})

    @property
    def last_start(self) -> float:
        """When the last S1 begins, ms."""
        return self.train.starts[-1]


class RestitutionConfig(Section):
    """The tissue and the protocol.

    ``tissue.duration`` is how long each case is watched from its S2 on, and ``tissue.n_steps`` the number of
    steps in that; ``tissue.stimuli`` plays no part.
    """

    tissue: ElectrophysiologyConfig
    protocol: RestitutionProtocol


class WindowProtocol(Section):
    """The time of the last stimulus is swept, and what becomes of its wave is looked at."""

    times: tuple[float, ...] = quantity(
        "ms", "times of the last stimulus to begin with, each a case of its own", "this project"
    )
    tolerance: float = quantity(
        "ms", "how closely the borders of the window are found", "this project", gt=0
    )
    least_share: float = quantity(
        "", "share of the film that a wave must activate to count", "this project", gt=0, lt=1
    )

    probes: dict[str, tuple[float, float]] = quantity(
        "mm", "points (X, Y) at which activations are counted, by name", "sec. 4.3"
    )

    @field_validator("times")
    @classmethod
    def _times_ascend(cls, times: tuple[float, ...]) -> tuple[float, ...]:
        if not times:
            raise PydanticCustomError("no_cases", "give at least one time")
        check_ascending(times)
        return times


class WindowConfig(Section):
    """The tissue and the protocol.

    ``tissue.duration`` is how long the film is watched from the last stimulus on, and ``tissue.n_steps``
    the number of steps in that; the last of ``tissue.stimuli`` is moved in time.
    """

    tissue: ElectrophysiologyConfig
    protocol: WindowProtocol


def check_ascending(times: tuple[float, ...]) -> None:
    """Refuse times that are negative, or do not ascend."""
    if times and times[0] < 0:
        raise PydanticCustomError(
            "ascending", "must be 0 ms or more, not {value}", {"value": f"{times[0]:g}"}
        )
    for before, after in pairwise(times):
        if not before < after:
            raise PydanticCustomError(
                "ascending",
                "must ascend, but {after} ms follows {before} ms",
                {"before": f"{before:g}", "after": f"{after:g}"},
            )
