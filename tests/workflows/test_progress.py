"""What is told while stages run."""

from __future__ import annotations

import pytest

from pipeline.events import (
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
    StageWarned,
)
from workflows.progress import PlainLines, watching


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
