"""Time laws: their values, files that are no course over time, and what enters a key."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from pydantic import TypeAdapter, ValidationError

from pipeline.canonical import digest
from stages.configuration import OneOf
from stages.time_laws.base import AnyTimeLaw, TimeLaw

ADAPTER: TypeAdapter[TimeLaw] = TypeAdapter(AnyTimeLaw)


def law(**fields: Any) -> TimeLaw:
    return ADAPTER.validate_python(fields)


def table(tmp_path: Path, text: str, name: str = "course.csv") -> TimeLaw:
    (tmp_path / name).write_bytes(text.encode())
    return law(name="table", file=str(tmp_path / name))


def test_the_laws_on_offer() -> None:
    names = OneOf("stages.time_laws", TimeLaw).names()
    assert names == ["constant", "ramp", "smooth-pulse", "table"]


def test_a_law_without_parameters_may_be_given_by_its_name() -> None:
    assert ADAPTER.validate_python("constant").at(17.0) == 1.0


def test_the_smooth_pulse_peaks_at_one_after_its_time_to_peak() -> None:
    pulse = law(name="smooth-pulse", time_to_peak=210.0)
    values = [pulse.at(float(t)) for t in range(501)]
    assert max(values) == values[210] == 1.0
    # eq. 103 by hand at t = 105 ms: 1/4 exp(3/4)
    assert values[105] == pytest.approx(0.25 * math.exp(0.75), rel=1e-15)
    assert pulse.at(-5.0) == 0.0


def test_a_ramp_holds_its_end() -> None:
    ramp = law(name="ramp", rise_time=42.0)
    assert [ramp.at(t) for t in (-1.0, 0.0, 21.0, 42.0, 100.0)] == [0.0, 0.0, 0.5, 1.0, 1.0]


def test_a_table_passes_through_its_points(tmp_path: Path) -> None:
    text = "\ufefftime [ms],factor\r\n# measured\r\n0,0\r\n\r\n10.5, 1\r\n30,0.25\r\n"
    course = table(tmp_path, text)
    assert [course.at(t) for t in (0.0, 10.5, 30.0)] == [0.0, 1.0, 0.25]
    # halfway between two points
    assert course.at(20.25) == pytest.approx(0.625, rel=1e-15)
    assert course.at(1e6) == 0.25


def test_the_content_of_a_table_enters_the_key_and_its_place_does_not(tmp_path: Path) -> None:
    one = table(tmp_path, "0,0\n10,1\n")
    same = table(tmp_path, "time,factor\n0.0,0.0\n10.0,1.0\n", name="elsewhere.csv")
    other = table(tmp_path, "0,0\n10,2\n")  # the same file, edited
    assert digest(one) == digest(same)
    assert digest(one) != digest(other)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("0,0\n10,1\n10,2\n", "line 3, '10,2', goes back in time: 10 ms comes before it"),
        ("0,0\n10;1\n", "line 2, '10;1', is not two finite numbers"),
        ("t,q\n0,0\nx,y\n", "line 3, 'x,y', is not two finite numbers"),
        ("0,0\n10,nan\n", "line 2, '10,nan', is not two finite numbers"),
        ("0,0,0\n", "line 1, '0,0,0', is not two finite numbers"),
        ("t,q\n0,0\n", "holds 1 points: at least two"),
        ("", "holds 0 points: at least two"),
    ],
)
def test_a_bad_table_is_refused_with_file_line_and_what_is_allowed(
    text: str, problem: str, tmp_path: Path
) -> None:
    with pytest.raises(ValidationError) as refusal:
        table(tmp_path, text)
    message = str(refusal.value)
    assert str(tmp_path / "course.csv") in message
    assert problem in message
    assert "a time in ms and a factor, two numbers separated by a comma" in message


def test_a_table_that_is_not_there_or_not_text_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValidationError, match=r"nowhere\.csv: cannot be read: No such file"):
        law(name="table", file=str(tmp_path / "nowhere.csv"))
    (tmp_path / "picture.csv").write_bytes(b"\x89\xff\xfe")
    with pytest.raises(ValidationError, match="not UTF-8 text"):
        law(name="table", file=str(tmp_path / "picture.csv"))


@pytest.mark.parametrize(
    ("fields", "problem"),
    [
        ({}, "needs a file, or time and factor"),
        ({"time": (0.0, 1.0), "factor": (0.0,)}, "time has 2 points, but factor has 1"),
        ({"time": (1.0, 1.0), "factor": (0.0, 1.0)}, "1 ms follows 1 ms"),
        ({"file": "a.csv", "time": (0.0, 1.0)}, "not both"),
    ],
)
def test_points_that_are_no_course_are_refused(fields: dict[str, Any], problem: str) -> None:
    with pytest.raises(ValidationError, match=problem):
        law(name="table", **fields)


def test_an_unknown_law_is_refused_with_the_names_on_offer() -> None:
    with pytest.raises(ValidationError, match="constant, ramp, smooth-pulse, table"):
        ADAPTER.validate_python("sawtooth")
