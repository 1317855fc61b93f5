"""What is told while stages run."""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from rich.progress import Progress

from pipeline.events import (
    Event,
    StageFailed,
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
    StageTold,
    StageWarned,
)
from workflows.progress import Bars, PlainLines, columns, watching


class Clock:
    """A clock that a test sets."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def told_over(seconds: float, steps: int) -> list[str]:
    """Lines of a stage that takes so long and reports each step."""
    lines: list[str] = []
    clock = Clock()
    listen = PlainLines(lines.append, clock)
    listen(StageStarted("mechanics", "mechanics", "k"))
    for step in range(1, steps + 1):
        clock.now = seconds * step / steps
        listen(StageProgress("mechanics", "mechanics", step, steps, clock.now))
    listen(StageFinished("mechanics", "mechanics", "k", seconds, 1000))
    return lines


def test_a_quick_stage_has_no_progress_lines() -> None:
    assert told_over(3.0, 1000) == ["mechanics: started", "mechanics: done in 3 s, 1 kB"]


def test_a_minute_has_a_line_every_ten_seconds() -> None:
    lines = told_over(60.0, 600)
    assert lines[1] == "mechanics: 17%, about 50 s left"
    assert len(lines) == 2 + 5


def test_hours_have_no_more_than_fifty_lines() -> None:
    assert len(told_over(36000.0, 7200)) <= 2 + 50


def test_the_time_left_follows_the_present_speed() -> None:
    lines: list[str] = []
    clock = Clock()
    listen = PlainLines(lines.append, clock)
    listen(StageStarted("m", "m", "k", resumed_frames=50))
    for now, done in ((100.0, 50), (120.0, 75)):
        clock.now = now
        listen(StageProgress("m", "m", done, 100, now))
    assert lines[0] == "m: resumed after 50 frames"
    assert lines[-1] == "m: 75%, about 20 s left"


def test_the_time_before_the_first_step_is_not_taken_for_slowness() -> None:
    lines: list[str] = []
    clock = Clock()
    listen = PlainLines(lines.append, clock)
    listen(StageStarted("m", "m", "k"))
    for now, done in ((60.0, 1), (80.0, 21)):  # a minute of compiling, then one step a second
        clock.now = now
        listen(StageProgress("m", "m", done, 100, now))
    assert lines == ["m: started", "m: 21%, about 1 min 19 s left"]


def test_an_expectation_is_told_at_the_start() -> None:
    lines: list[str] = []
    PlainLines(lines.append)(StageStarted("m", "m", "k", expected_seconds=200.0))
    assert lines == ["m: started (a similar run took 3 min 20 s)"]


def test_quiet_tells_warnings_only(capsys: pytest.CaptureFixture[str]) -> None:
    with watching(quiet=True) as listen:
        listen(StageHit("m", "m", "k"))
        listen(StageWarned("m", "m", "the step was halved"))
    out, err = capsys.readouterr()
    assert (out, err) == ("", "m: warning: the step was halved\n")


def test_single_lines_of_a_stage_are_told_on_demand_only(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for flags in ({}, {"verbose": True}):
        with watching(**flags) as listen:
            listen(StageTold("m", "m", "step 3: 4 iterations"))
    assert capsys.readouterr().out == "m: step 3: 4 iterations\n"


def shown(width: int, *events: Event) -> str:
    """What a terminal so wide shows after these events."""
    console = Console(width=width, file=io.StringIO(), force_terminal=True, color_system=None)
    progress = Progress(*columns(width), console=console)
    listen = Bars(progress)
    for event in events:
        listen(event)
    with console.capture() as captured:
        console.print(progress.get_renderable())
    return captured.get().rstrip("\n")


STARTED = StageStarted("electrophysiology", "electrophysiology", "k")


@pytest.mark.parametrize("width", [30, 40, 54, 100])
def test_times_are_never_cut(width: int) -> None:
    line = shown(width, STARTED, StageProgress("electrophysiology", "e", 5, 100, 9.0))
    assert line.startswith("electrophysiology ")
    assert "5%" in line
    assert line.endswith("-:--:--")
    assert ("0:00:00 " in line) == (width >= 40)
    assert len(line.splitlines()) == 1
    assert len(line) <= width


def test_a_stage_is_seen_before_its_first_step() -> None:
    assert "electrophysiology" in shown(80, STARTED)
    assert "━" in shown(80, STARTED)
    finished = StageFinished("electrophysiology", "electrophysiology", "k", 1.0, 1)
    failed = StageFailed("electrophysiology", "electrophysiology", "no convergence")
    assert shown(80, STARTED, finished) == ""
    assert shown(80, STARTED, failed) == ""
