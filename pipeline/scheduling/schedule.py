"""Which node is computed when: as soon as its key is known, and once for all cases that need it.

A node is looked up, and submitted if it is not there, as soon as the results that it takes as inputs are
known, since its key states their contents. Cases are taken from their iterable only as there is room
for work, and forgotten when they are done, so that their number is not bounded by memory.
"""

from __future__ import annotations

import heapq
from collections import deque
from collections.abc import Callable, Hashable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

from pipeline.computing.obtaining import Obtained, Policy, expected_seconds, look, obtain
from pipeline.errors import StageError
from pipeline.events import (
    CaseEvent,
    Event,
    Listener,
    StageFinished,
    StageHit,
    StageStarted,
    StageStopping,
)
from pipeline.executors.protocol import Completion, Executor, LostJob
from pipeline.plan import statement_of
from pipeline.running.interrupts import Interrupts
from pipeline.scheduling.cases import Case, CaseDone, CaseFailed, CaseResult, OpenCase
from pipeline.scheduling.outcome import Outcome
from pipeline.scheduling.recent import Recent
from pipeline.store import Store
from pipeline.task import Codes, Task

Finish: TypeAlias = Callable[[Any, Mapping[str, Outcome]], Any]

OPEN = 1000
"""Cases under way at most: so many may wait for the same result before others are looked at."""

REMEMBERED = 10_000
"""Results whose facts are kept in memory; others are looked up in the store again."""

LOST_REMEDY = "look into the log of the workers; if they ran out of memory, start fewer of them on one machine"

POLL = 0.2
"""Seconds in which a signal is noticed while other processes work."""


_Place: TypeAlias = tuple[int, int]
"""Number of a case and position of a node in it; smaller ones go first."""


@dataclass
class _Job:
    """A submitted computation, and the places that wait for it."""

    case: str
    node: str
    stage: str
    waiting: list[_Place]
    running: bool = False


class Schedule:
    """The cases under way, the jobs submitted for them, and what is known of results.

    Iterating carries it out. See :func:`pipeline.sweep.sweep` for the parameters.
    """

    def __init__(
        self,
        cases: Iterator[Case],
        store: Store,
        executor: Executor,
        finish: Finish | None,
        listen: Listener,
        policy: Policy,
        interrupts: Interrupts,
    ) -> None:
        self._cases, self._store, self._executor = cases, store, executor
        self._finish, self._listen, self._policy = finish, listen, policy
        self._interrupts = interrupts
        self._codes = Codes()
        self._more = True
        self._opened = 0
        self._open: dict[int, OpenCase] = {}
        self._ready: list[_Place] = []
        self._jobs: dict[Hashable, _Job] = {}
        self._known: Recent[Obtained] = Recent(REMEMBERED)
        self._failed: Recent[Exception] = Recent(REMEMBERED)
        self._seconds: dict[str, float] = {}
        self._results: deque[CaseResult] = deque()

    def __iter__(self) -> Iterator[CaseResult]:
        while True:
            self._check_signals()
            while self._results:
                yield self._results.popleft()
            if self._begin_something():
                if not self._executor.in_process:
                    self._take(0.0)  # whoever is done must not wait until all cases are looked at
            elif self._jobs:
                self._take(None if self._executor.in_process else POLL)
            elif not self._results:
                return

    def _begin_something(self) -> bool:
        """Take one place from the queue, or open one case; ``False`` if there is no use in it."""
        if self._results or len(self._jobs) >= self._executor.slots:
            return False
        if self._ready:
            number, position = heapq.heappop(self._ready)
            if number in self._open:
                self._begin(number, position)
            return True
        return len(self._open) < OPEN and self._open_next()

    def _open_next(self) -> bool:
        case = next(self._cases, None) if self._more else None
        self._more = case is not None
        if case is None:
            return False
        self._opened += 1
        try:
            opened = OpenCase.of(case, self._codes)
        except Exception as error:
            self._results.append(CaseFailed(case.name, "", error, {}))
            return True
        self._open[self._opened] = opened
        self._push(self._opened, opened.first_ready())
        return True

    def _push(self, number: int, positions: Iterable[int]) -> None:
        for position in positions:
            heapq.heappush(self._ready, (number, position))

    def _begin(self, number: int, position: int) -> None:
        """Look a ready node up, join those who wait for it, or submit it."""
        opened = self._open[number]
        if position == opened.last:
            self._begin_finish(number, opened)
            return
        name, node = opened.order[position]
        try:
            inputs = opened.inputs(position)
            stated = statement_of(node, opened.codes[position], inputs)
            if (error := self._failed.get(stated.key)) is not None:
                self._fail(number, node.stage.name, error)
                return
            if stated.key in self._jobs:
                self._jobs[stated.key].waiting.append((number, position))
                return
            tell = self._teller(opened.case.name)
            found = self._known.get(stated.key)
            if found is not None:
                tell(StageHit(name, found.stage, found.key))
            else:
                found = look(name, stated.ref, self._store, tell, self._policy)
            if found is not None:
                self._arrived(number, position, replace(found, hit=True))
                return
            stage = node.stage.name
            if stage not in self._seconds:  # else a case of this study tells well enough
                self._seconds[stage] = expected_seconds(stated, inputs, self._store) or 0.0
            task = Task.of(name, node, stated, inputs, self._seconds[stage] or None)
            self._executor.submit(stated.key, obtain, task, self._store, self._policy)
        except Exception as error:
            self._fail(number, node.stage.name, error)
            return
        self._jobs[stated.key] = _Job(opened.case.name, name, stage, [(number, position)])

    def _begin_finish(self, number: int, opened: OpenCase) -> None:
        outcomes = opened.outcomes(self._store)
        if self._finish is None:
            del self._open[number]
            self._results.append(CaseDone(opened.case.name, outcomes))
            return
        try:
            self._executor.submit(number, _finished, self._finish, opened.case.about, outcomes)
        except Exception as error:
            self._fail(number, "", error)
            return
        self._jobs[number] = _Job(opened.case.name, "", "", [(number, opened.last)])

    def _take(self, timeout: float | None) -> None:
        """Wait for a job to end, and do what follows from it."""
        completion = self._executor.next(self._hear, timeout)
        if completion is None:
            return
        job = self._jobs.pop(completion.tag)
        if isinstance(completion.error, KeyboardInterrupt):
            raise completion.error
        if job.stage:
            self._computed(completion, job)
            return
        for number, _ in job.waiting:
            if completion.error is not None:
                self._fail(number, "", completion.error)
            elif (opened := self._open.pop(number, None)) is not None:
                outcomes = opened.outcomes(self._store)
                self._results.append(CaseDone(opened.case.name, outcomes, completion.value))

    def _computed(self, completion: Completion, job: _Job) -> None:
        """Hand a result, or the error instead of it, to all who wait for it."""
        if isinstance(error := completion.error, Exception):
            if isinstance(error, LostJob):
                error = StageError(job.stage, str(error), remedy=LOST_REMEDY)
            self._failed.add(completion.tag, error)
            for number, _ in job.waiting:
                self._fail(number, job.stage, error)
            return
        found: Obtained = completion.value
        self._known.add(found.key, found)
        if not found.hit:
            self._seconds[found.stage] = found.seconds
        for nth, (number, position) in enumerate(job.waiting):
            if nth and (opened := self._open.get(number)) is not None:
                name = opened.order[position][0]
                self._teller(opened.case.name)(StageHit(name, found.stage, found.key))
                found = replace(found, hit=True)
            self._arrived(number, position, found)

    def _arrived(self, number: int, position: int, found: Obtained) -> None:
        if number in self._open:
            self._push(number, self._open[number].add(position, found))

    def _fail(self, number: int, stage: str, error: Exception) -> None:
        if (opened := self._open.pop(number, None)) is not None:
            outcomes = opened.outcomes(self._store)
            self._results.append(CaseFailed(opened.case.name, stage, error, outcomes))

    def _hear(self, tag: Hashable, event: Event) -> None:
        """An event of a running job; one that ended meanwhile is known to have."""
        if (job := self._jobs.get(tag)) is None:
            return
        if isinstance(event, StageStarted | StageFinished):
            job.running = isinstance(event, StageStarted)
        self._teller(job.case)(event)

    def _teller(self, case: str) -> Listener:
        return (lambda event: self._listen(CaseEvent(case, event))) if case else self._listen

    def _check_signals(self) -> None:
        """After a signal let running stages save their work, then stop; another one stops at once."""
        if not self._interrupts.requested:
            return
        for job in self._jobs.values():
            if job.running:
                self._teller(job.case)(StageStopping(job.node, job.stage))
        self._executor.stop()
        while self._jobs:
            completion = self._executor.next(self._hear, POLL)
            if completion is not None:
                self._jobs.pop(completion.tag)
        self._interrupts.check()


def _finished(
    finish: Finish, about: Any, outcomes: Mapping[str, Outcome], *, tell: Listener
) -> Any:
    return finish(about, outcomes)
