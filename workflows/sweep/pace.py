"""How far a sweep is and how long it will still take, from what happened so far."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from pipeline.events import (
    CaseEvent,
    Event,
    StageFailed,
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
)
from workflows.sweep.forecast import Forecast


@dataclass
class StagePace:
    """One stage over all cases.

    Attributes
    ----------
    planned
        Results that the cases need, told apart by what is known before their inputs are there.
    expected
        Seconds that one took in the past, if that is known.
    seen
        Numbers of the planned results that are there.
    there
        Their keys: fewer, if inputs came out the same.
    computed, seconds
        Keys of those that were computed by now, and their time together.
    """

    planned: int
    expected: float | None = None
    seen: set[int] = field(default_factory=set)
    there: set[str] = field(default_factory=set)
    computed: set[str] = field(default_factory=set)
    seconds: float = 0.0

    @property
    def missing(self) -> float:
        """Results that are still to come, if as many turn out the same as up to now."""
        fresh = len(self.there) / len(self.seen) if self.seen else 1.0
        return max(self.planned - len(self.seen), 0) * fresh

    @property
    def total(self) -> int:
        """Results in the end."""
        return len(self.there) + math.ceil(self.missing)

    @property
    def mean(self) -> float | None:
        """Seconds for one."""
        return self.seconds / len(self.computed) if self.computed else self.expected


class Pace:
    """Follows the events of a sweep.

    Parameters
    ----------
    cases
        Number of each case, by its name.
    forecast
        What they need.
    clock
        Seconds.
    """

    def __init__(
        self,
        cases: Mapping[str, int],
        forecast: Forecast,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.cases, self.done, self.failed = len(cases), 0, 0
        self.stages = {
            name: StagePace(stage.different, stage.seconds)
            for name, stage in forecast.stages.items()
        }
        self._numbers, self._planned = cases, forecast.cases
        self._clock = clock
        self._running: dict[tuple[str, str], tuple[str, float]] = {}
        self._shares: dict[tuple[str, str], float] = {}
        self._most = 1

    def __call__(self, event: Event) -> None:
        """Take one event into account."""
        case, inner = (event.case, event.event) if isinstance(event, CaseEvent) else ("", event)
        node = (case, getattr(inner, "node", ""))
        if isinstance(inner, StageStarted):
            self._running[node] = (inner.stage, self._clock())
            self._most = max(self._most, len(self._running))
        elif isinstance(inner, StageProgress):
            self._shares[node] = inner.done / inner.total
        elif isinstance(inner, StageFinished | StageFailed):
            self._running.pop(node, None)
            self._shares.pop(node, None)
        if isinstance(inner, StageHit | StageFinished):
            stage = self.stages[inner.stage]
            stage.there.add(inner.key)
            stage.seen.add(self._planned[self._numbers[case]][inner.node])
        if isinstance(inner, StageFinished):
            stage.computed.add(inner.key)
            stage.seconds += inner.seconds

    def case_done(self, *, failed: bool) -> None:
        """Count a case that has ended."""
        self.done += not failed
        self.failed += failed

    def share(self, name: str) -> float:
        """Results of a stage that are there, those that are being computed in part."""
        parts = (
            self._shares.get(node, 0.0)
            for node, (stage, _) in self._running.items()
            if stage == name
        )
        return len(self.stages[name].there) + sum(parts)

    def left(self) -> float | None:
        """Seconds until all is done, ``None`` while that cannot be known.

        The results that are missing, each for the mean time of its stage, by as many at a time as ever
        ran together. What failed cases no longer need is counted, too, so it is at most this.
        """
        seconds = 0.0
        for stage in self.stages.values():
            if stage.missing and stage.mean is None:
                return None
            seconds += stage.missing * (stage.mean or 0.0)
        for name, began in self._running.values():
            mean = self.stages[name].mean if name in self.stages else None
            seconds -= min(self._clock() - began, mean or 0.0)
        return max(seconds, 0.0) / self._most
