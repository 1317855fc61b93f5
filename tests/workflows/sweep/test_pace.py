"""How far a sweep is, and what is told of it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from pipeline.events import (
    CaseEvent,
    Event,
    StageFinished,
    StageHit,
    StageProgress,
    StageStarted,
    StageWarned,
)
from workflows.sweep.forecast import Forecast, StageForecast
from workflows.sweep.pace import Pace
from workflows.sweep.progress import CaseLines, Noteworthy, summary


class Clock:
    """Seconds that a test sets."""

    now = 0.0

    def __call__(self) -> float:
        """The time."""
        return self.now


def pace(clock: Clock) -> Pace:
    """Four cases of two stages: ``waves`` looks different in each, ``shape`` is."""
    stages = {
        "waves": StageForecast("waves", different=4, open=4),
        "shape": StageForecast("shape", different=4, seconds=2.0),
    }
    cases = [{"waves": i, "shape": 10 + i} for i in range(4)]
    planned = cast(Forecast, SimpleNamespace(stages=stages, cases=cases))
    return Pace({str(i): i for i in range(4)}, planned, clock)


def began(case: int, stage: str) -> Event:
    """A stage begins."""
    return CaseEvent(str(case), StageStarted(stage, stage, "key"))


def ended(case: int, stage: str, key: str, seconds: float) -> Event:
    """A stage has been computed."""
    return CaseEvent(str(case), StageFinished(stage, stage, key, seconds, 1))


def test_time_left_is_unknown_before_anything_like_it_has_run() -> None:
    assert pace(Clock()).left() is None


def test_time_left_counts_what_is_missing_at_the_mean_time_of_its_stage() -> None:
    going = pace(Clock())
    for case in range(4):
        going(ended(case, "waves", f"w{case}", 10.0))
    assert going.left() == pytest.approx(4 * 2.0)  # as long as past ones
    going(ended(0, "shape", "s0", 3.0))
    assert going.left() == pytest.approx(3 * 3.0)  # as long as those of this sweep


def test_what_turns_out_to_be_shared_is_expected_to_go_on_so() -> None:
    going = pace(Clock())
    going(ended(0, "waves", "same", 10.0))
    assert going.stages["waves"].total == 4
    going(CaseEvent("1", StageHit("waves", "waves", "same")))
    going(CaseEvent("2", StageHit("waves", "waves", "same")))
    assert going.stages["waves"].missing == pytest.approx(1 / 3)
    going(CaseEvent("3", StageHit("waves", "waves", "same")))
    assert going.stages["waves"].total == 1
    assert going.left() == pytest.approx(4 * 2.0)


def test_stages_that_run_together_halve_the_time_left_and_running_ones_shorten_it() -> None:
    clock = Clock()
    going = pace(clock)
    for case in range(4):
        going(ended(case, "waves", f"w{case}", 10.0))
    going(began(0, "shape"))
    going(began(1, "shape"))
    assert going.left() == pytest.approx(8.0 / 2)
    clock.now = 1.0
    assert going.left() == pytest.approx((8.0 - 2 * 1.0) / 2)


def test_a_running_stage_counts_in_part() -> None:
    going = pace(Clock())
    going(began(0, "shape"))
    going(CaseEvent("0", StageProgress("shape", "shape", 1, 4, 0.5)))
    assert going.share("shape") == pytest.approx(0.25)


def test_lines_come_every_ten_seconds_and_failures_at_once() -> None:
    clock, said = Clock(), []
    lines = CaseLines(lambda line, problem: said.append((line, problem)), pace(clock), clock=clock)
    lines(ended(0, "waves", "w0", 1.0))
    lines.case_done("0", None)
    assert said == []
    lines.case_done("1", "no convergence\nRemedy: smaller steps")
    lines.case_done("2", "as before", earlier=True)
    assert said == [("case 1 failed: no convergence", True)]
    clock.now = 11.0
    lines(ended(3, "waves", "w3", 1.0))
    assert said[1:] == [("3 of 4 cases, 2 failed (waves 2/4, shape 0/4), about 10 s left", False)]


def test_warnings_that_differ_in_numbers_only_are_told_once_and_counted() -> None:
    def warned(case: str, elements: int) -> Event:
        return CaseEvent(case, StageWarned("shape", "shape", f"take {elements} elements"))

    events: list[Any] = [warned("0", 8), warned("1", 9), warned("2", 12)]
    usual, verbose = Noteworthy(verbose=False), Noteworthy(verbose=True)
    assert [usual(event) for event in events] == ["0, shape: warning: take 8 elements", "", ""]
    assert usual.repeated() == ["shape: 2 more such warnings: take 8 elements"]
    assert all(verbose(event) for event in events)
    assert verbose.repeated() == []


def test_a_summary_counts_cases() -> None:
    going = pace(Clock())
    going.case_done(failed=False)
    assert summary(going) == "1 of 4 cases"
