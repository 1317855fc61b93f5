"""How far a sweep is and how long it will still take, from what happened so far."""

from __future__ import annotations

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
from workflows.sweep.forecast import StageForecast


@dataclass
class StagePace:
    """One stage over all cases.

    Attributes
    ----------
    total
        Different results that the cases need.
    expected
        Seconds that one took in the past, if that is known.
    there
        Keys of those that are there.
    computed, seconds
        How many were computed by now, and their time together.
    """

    total: int
    expected: float | None = None
    there: set[str] = field(default_factory=set)
    computed: int = 0
    seconds: float = 0.0

    @property
    def mean(self) -> float | None:
        """Seconds for one."""
        return self.seconds / self.computed if self.computed else self.expected


class Pace:
    """Follows the events of a sweep.

    Parameters
    ----------
    cases
        Number of cases.
    stages
        What they need.
    clock
        Seconds.
    """

    def __init__(
        self,
        cases: int,
        stages: Mapping[str, StageForecast],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.cases, self.done, self.failed = cases, 0, 0
        self.stages = {name: StagePace(s.different, s.seconds) for name, s in stages.items()}
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
            stage = self.stages.setdefault(inner.stage, StagePace(0))
            stage.there.add(inner.key)
            stage.total = max(stage.total, len(stage.there))
        if isinstance(inner, StageFinished):
            stage.computed += 1
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
            missing = stage.total - len(stage.there)
            if missing and stage.mean is None:
                return None
            seconds += missing * (stage.mean or 0.0)
        for name, began in self._running.values():
            mean = self.stages[name].mean if name in self.stages else None
            seconds -= min(self._clock() - began, mean or 0.0)
        return max(seconds, 0.0) / self._most
