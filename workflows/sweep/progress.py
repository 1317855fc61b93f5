"""What the user sees while a sweep runs: bars on a terminal, a line now and then elsewhere."""

from __future__ import annotations

import contextlib
import sys
import textwrap
import time
from collections import Counter
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Protocol

from pipeline.events import CaseEvent, Event, StageStopping, StageWarned
from workflows.progress import SECONDS_BETWEEN_LINES, duration, on_terminal, told
from workflows.sweep.kinds import kind_of
from workflows.sweep.pace import Pace

if TYPE_CHECKING:
    from rich.progress import Progress, TaskID


class Noteworthy:
    """Picks what is told of a sweep: of warnings that differ in numbers only, the first.

    Parameters
    ----------
    verbose
        Whether every event is told.
    """

    def __init__(self, *, verbose: bool) -> None:
        self._verbose = verbose
        self._warned: Counter[tuple[str, str]] = Counter()
        self._first: dict[tuple[str, str], str] = {}

    def __call__(self, event: Event) -> str:
        """Line about an event, empty for those that say nothing about a sweep as a whole."""
        case, inner = (event.case, event.event) if isinstance(event, CaseEvent) else ("", event)
        if isinstance(inner, StageWarned):
            kind = (inner.node, kind_of(inner.message))
            self._warned[kind] += 1
            self._first.setdefault(kind, inner.message)
            if self._warned[kind] > 1 and not self._verbose:
                return ""
        elif not self._verbose and not isinstance(inner, StageStopping):
            return ""
        line = told(inner)
        return f"{case}, {line}" if line and case else line

    def repeated(self) -> list[str]:
        """Lines about the warnings that were left out."""
        if self._verbose:
            return []
        return [
            f"{kind[0]}: {count - 1} more such warnings: "
            + textwrap.shorten(self._first[kind], 76, placeholder=" ...")
            for kind, count in self._warned.items()
            if count > 1
        ]


class Display(Protocol):
    """Tells how a sweep goes."""

    noteworthy: Noteworthy

    def __call__(self, event: Event) -> None:
        """Tell one event, if it is worth it."""
        ...

    def case_done(self, name: str, error: str | None, *, earlier: bool = False) -> None:
        """Tell that a case has ended, with its error if it failed, unless it did so ``earlier``."""
        ...


@contextlib.contextmanager
def watching_cases(pace: Pace, *, quiet: bool, verbose: bool) -> Iterator[Display]:
    """Display that suits where the output goes; when quiet, warnings and failures only."""
    with contextlib.ExitStack() as stack:
        display: Display = CaseLines(_say, pace, quiet=quiet, verbose=verbose)
        if not quiet and on_terminal():
            display = CaseBars(stack.enter_context(_live_display()), pace, verbose=verbose)
        yield display
    for line in display.noteworthy.repeated():
        _say(line, True)


def _live_display() -> Progress:
    from rich.progress import BarColumn, Progress, TextColumn

    return Progress(
        TextColumn("{task.description}"),
        BarColumn(bar_width=None),
        TextColumn("{task.fields[told]}"),
        transient=True,
    )


def summary(pace: Pace) -> str:
    """How far all is, in words.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> summary(SimpleNamespace(done=1, failed=1, cases=21))
    '2 of 21 cases, 1 failed'
    """
    words = f"{pace.done + pace.failed} of {pace.cases} cases"
    return words + (f", {pace.failed} failed" if pace.failed else "")


class CaseLines:
    """Lines: the state every ten seconds, and at once what is wrong.

    Parameters
    ----------
    say
        Writes a line.
    pace
        State of the sweep, which hears of everything first.
    quiet, verbose
        Whether to tell problems only; whether to tell every stage of every case.
    clock
        Seconds.
    """

    def __init__(
        self,
        say: Callable[[str, bool], None],
        pace: Pace,
        *,
        quiet: bool = False,
        verbose: bool = False,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._say, self._pace, self._clock = say, pace, clock
        self._quiet, self._last = quiet, clock()
        self.noteworthy = Noteworthy(verbose=verbose)

    def __call__(self, event: Event) -> None:
        """Tell one event."""
        self._pace(event)
        if line := self.noteworthy(event):
            self._say(line, True)
        self._now_and_then()

    def case_done(self, name: str, error: str | None, *, earlier: bool = False) -> None:
        """Tell a failure at once."""
        self._pace.case_done(failed=error is not None)
        if error is not None and not earlier:
            self._say(f"case {name} failed: {error.splitlines()[0]}", True)
        self._now_and_then()

    def _now_and_then(self) -> None:
        now = self._clock()
        if self._quiet or now - self._last < SECONDS_BETWEEN_LINES:
            return
        self._last = now
        stages = ", ".join(
            f"{name} {len(stage.there)}/{stage.total}" for name, stage in self._pace.stages.items()
        )
        left = self._pace.left()
        more = f", about {duration(left)} left" if left is not None else ""
        self._say(f"{summary(self._pace)} ({stages}){more}", False)


class CaseBars:
    """A bar for all cases and one per stage; what is noteworthy are lines above them.

    Parameters
    ----------
    progress
        Where the bars are.
    pace
        State of the sweep, which hears of everything first.
    verbose
        Whether to tell every stage of every case.
    """

    def __init__(self, progress: Progress, pace: Pace, *, verbose: bool = False) -> None:
        self._progress, self._pace = progress, pace
        self.noteworthy = Noteworthy(verbose=verbose)
        self._cases = progress.add_task("cases", total=pace.cases, told="")
        self._stages: dict[str, TaskID] = {}
        self._update()

    def __call__(self, event: Event) -> None:
        """Tell one event."""
        self._pace(event)
        if line := self.noteworthy(event):
            self._progress.console.print(line, highlight=False, markup=False)
        self._update()

    def case_done(self, name: str, error: str | None, *, earlier: bool = False) -> None:
        """Move the bar of the cases."""
        self._pace.case_done(failed=error is not None)
        if error is not None and not earlier:
            line = f"case {name} failed: {error.splitlines()[0]}"
            self._progress.console.print(line, highlight=False, markup=False)
        self._update()

    def _update(self) -> None:
        left = self._pace.left()
        more = f", about {duration(left)} left" if left is not None else ""
        ended = self._pace.done + self._pace.failed
        self._progress.update(self._cases, completed=ended, told=summary(self._pace) + more)
        for name, stage in self._pace.stages.items():
            if name not in self._stages:
                self._stages[name] = self._progress.add_task(f"  {name}", told="")
            self._progress.update(
                self._stages[name],
                total=stage.total,
                completed=self._pace.share(name),
                told=f"{len(stage.there)} of {stage.total}",
            )


def _say(line: str, problem: bool) -> None:
    print(line, file=sys.stderr if problem else sys.stdout, flush=True)
