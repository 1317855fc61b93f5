"""What the user sees while stages run: bars on a terminal, plain lines elsewhere."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from pipeline.events import (
    Event,
    Listener,
    StageFailed,
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
    StageStopping,
    StageTold,
    StageWaiting,
    StageWarned,
)

if TYPE_CHECKING:
    from rich.progress import Progress, ProgressColumn, TaskID

SECONDS_BETWEEN_LINES = 10.0
SHARE_BETWEEN_LINES = 0.02
"""Plain lines come at most every ten seconds, and at most fifty times per stage."""

WIDTH_FOR_BOTH_TIMES = 40
WIDTH_FOR_A_BAR = 54
"""Columns of a terminal; the longest name has 17 characters, a time up to 8, a percentage 4."""


@contextlib.contextmanager
def watching(*, quiet: bool = False, verbose: bool = False) -> Iterator[Listener]:
    """Listener that suits where the output goes.

    When quiet, only warnings are told; when verbose, also the single lines of the stages.
    """
    if quiet:
        yield _only_warnings
        return
    with contextlib.ExitStack() as stack:
        listen: Listener = PlainLines(_say)
        if on_terminal():
            listen = Bars(stack.enter_context(_live_display()))
        yield listen if verbose else _without_details(listen)


def on_terminal() -> bool:
    """Whether someone may be watching."""
    return sys.stdout is not None and sys.stdout.isatty()


class PlainLines:
    """Tells events line by line.

    Parameters
    ----------
    say
        Writes a line.
    clock
        Seconds.
    """

    def __init__(
        self, say: Callable[[str], None], clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._say = say
        self._clock = clock
        self._last: dict[str, tuple[float, float]] = {}

    def __call__(self, event: Event) -> None:
        """Tell one event."""
        if isinstance(event, StageStarted):
            self._last.pop(event.node, None)
        if isinstance(event, StageProgress):
            self._progress(event)
        elif line := told(event):
            self._say(line)

    def _progress(self, event: StageProgress) -> None:
        """The first event only starts the clock: compiling may come before it."""
        now, share = self._clock(), event.done / event.total
        begun, begun_share = self._last.setdefault(event.node, (now, share))
        if now - begun < SECONDS_BETWEEN_LINES or share - begun_share < SHARE_BETWEEN_LINES:
            return
        if event.done == event.total:
            return
        left = (1 - share) * (now - begun) / (share - begun_share)
        self._last[event.node] = (now, share)
        self._say(f"{event.node}: {share:.0%}, about {duration(left)} left")


def told(event: Event) -> str:
    """One line about an event, empty for those not worth one."""
    if isinstance(event, StageHit):
        return f"{event.node}: in the store"
    if isinstance(event, StageStarted):
        resumed = event.resumed_frames
        begun = "started" if resumed is None else f"resumed after {resumed} frames"
        expected = event.expected_seconds
        return f"{event.node}: {begun}" + (
            f" (a similar run took {duration(expected)})" if expected is not None else ""
        )
    if isinstance(event, StageWaiting):
        return f"{event.node}: being computed by {event.holder}; waiting for it"
    if isinstance(event, StageWarned):
        return f"{event.node}: warning: {event.message}"
    if isinstance(event, StageTold):
        return f"{event.node}: {event.message}"
    if isinstance(event, StageStopping):
        return f"{event.node}: stopping at the next checkpoint (a second signal stops at once)"
    if isinstance(event, StageFinished):
        return f"{event.node}: done in {duration(event.seconds)}, {size(event.size)}"
    return ""


def duration(seconds: float) -> str:
    """Seconds in readable form.

    Examples
    --------
    >>> duration(0.04), duration(42.3), duration(200), duration(7300)
    ('0.04 s', '42 s', '3 min 20 s', '2 h 1 min')
    """
    if seconds < 10:
        return f"{seconds:.2g} s"
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def size(count: float) -> str:
    """Bytes in readable form.

    Examples
    --------
    >>> size(512), size(23_400_000)
    ('512 B', '23.4 MB')
    """
    for unit in ("B", "kB", "MB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} GB"


def _say(line: str) -> None:
    print(line, flush=True)


def _only_warnings(event: Event) -> None:
    if isinstance(event, StageWarned):
        print(told(event), file=sys.stderr, flush=True)


def _without_details(listen: Listener) -> Listener:
    def usual(event: Event) -> None:
        if not isinstance(event, StageTold):
            listen(event)

    return usual


def _live_display() -> Progress:
    from rich.console import Console
    from rich.progress import Progress

    console = Console()
    return Progress(*columns(console.width), console=console, transient=True)


def columns(width: int) -> list[ProgressColumn]:
    """What is told of a stage in a terminal so wide; times would be cut before the bar shrinks."""
    from rich.progress import (
        BarColumn,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    chosen: list[ProgressColumn] = [TextColumn("{task.description}"), TaskProgressColumn()]
    if width >= WIDTH_FOR_BOTH_TIMES:
        chosen.append(TimeElapsedColumn())
    if width >= WIDTH_FOR_A_BAR:
        chosen.insert(1, BarColumn(bar_width=None))
    return [*chosen, TimeRemainingColumn()]


class Bars:
    """One bar per running stage; other events are lines above it.

    Until a stage reports its first step, which may come after seconds of compiling, the bar moves
    to and fro.

    Parameters
    ----------
    progress
        Where the bars are.
    """

    def __init__(self, progress: Progress) -> None:
        self._progress = progress
        self._tasks: dict[str, TaskID] = {}

    def __call__(self, event: Event) -> None:
        """Tell one event."""
        if isinstance(event, StageStarted):
            self._tasks[event.node] = self._progress.add_task(event.node, total=None)
        if isinstance(event, StageProgress):
            if event.node not in self._tasks:
                self._tasks[event.node] = self._progress.add_task(event.node)
            self._progress.update(self._tasks[event.node], total=event.total, completed=event.done)
        if isinstance(event, StageFinished | StageFailed) and event.node in self._tasks:
            self._progress.remove_task(self._tasks.pop(event.node))
        if line := told(event):
            self._progress.console.print(line, highlight=False, markup=False)
