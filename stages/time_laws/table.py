"""Measured course over time: points of a CSV file, joined by straight lines."""

from __future__ import annotations

import csv
import math
from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import quantity, unkeyed
from stages.time_laws.base import TimeLaw

ALLOWED = (
    "each line holds a time in ms and a factor, two numbers separated by a comma, with times that "
    "increase; the first line may hold names, and lines that begin with # are skipped"
)


class Table(TimeLaw):
    """Points (t, q). The file is read once, when the configuration is; its content enters the key."""

    name: Literal["table"] = "table"
    file: str | None = unkeyed(
        "CSV file with time [ms] and factor; its folder is that of the command", default=None
    )
    time: tuple[float, ...] = quantity("ms", "times of the points", "this project", default=())
    factor: tuple[float, ...] = quantity("", "factors at the points", "this project", default=())

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any) -> Any:
        if not isinstance(data, dict) or not isinstance(data.get("file"), str):
            return data
        if "time" in data or "factor" in data:
            raise PydanticCustomError(
                "table", "give either a file, or time and factor, not both", {}
            )
        points = list(_points(Path(data["file"]).expanduser()))
        return data | {
            "time": tuple(time for _, time, _ in points),
            "factor": tuple(factor for _, _, factor in points),
        }

    @model_validator(mode="after")
    def _is_a_course(self) -> Table:
        for problem in self._problems():
            raise PydanticCustomError("table", "{problem}", {"problem": problem})
        return self

    def _problems(self) -> Iterator[str]:
        if len(self.time) != len(self.factor):
            yield f"time has {len(self.time)} points, but factor has {len(self.factor)}"
        elif len(self.time) < 2:
            yield "needs a file, or time and factor, with two points at least"
        for before, after in zip(self.time, self.time[1:], strict=False):
            if not before < after:
                yield f"times must increase, but {after:g} ms follows {before:g} ms"

    def at(self, time: float) -> float:
        """Between two points linear; before the first one and after the last one their value.

        Examples
        --------
        >>> law = Table(time=(0.0, 10.0, 30.0), factor=(0.0, 1.0, 0.5))
        >>> [law.at(t) for t in (-1.0, 5.0, 10.0, 20.0, 99.0)]
        [0.0, 0.5, 1.0, 0.75, 0.5]
        """
        right = bisect_right(self.time, time)
        if right == 0:
            return self.factor[0]
        if right == len(self.time):
            return self.factor[-1]
        (a, b), (low, high) = self.time[right - 1 : right + 1], self.factor[right - 1 : right + 1]
        return low + (high - low) * (time - a) / (b - a)


def _points(path: Path) -> Iterator[tuple[int, float, float]]:
    """Line number, time and factor of each point."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise _refused(path, f"cannot be read: {reason}", "give the path of a CSV file") from error
    last, found = -math.inf, 0
    for line, cells in enumerate(csv.reader(text.splitlines()), start=1):
        if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
            continue
        values = [_number(cell) for cell in cells]
        if not found and len(cells) == 2 and values == [None, None]:
            found = -1  # names of the columns
            continue
        place = f"line {line}, {','.join(cells)!r},"
        if len(values) != 2 or None in values:
            raise _refused(path, f"{place} is not two finite numbers")
        time, factor = values
        assert time is not None
        assert factor is not None
        if time <= last:
            raise _refused(path, f"{place} goes back in time: {last:g} ms comes before it")
        yield line, time, factor
        last, found = time, max(found, 0) + 1
    if found < 2:
        raise _refused(path, f"holds {max(found, 0)} points: at least two are needed")


def _number(cell: str) -> float | None:
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _refused(path: Path, problem: str, allowed: str = ALLOWED) -> PydanticCustomError:
    return PydanticCustomError(
        "time_table",
        "file {path}: {problem}; {allowed}",
        {"path": str(path), "problem": problem, "allowed": allowed},
    )


MODEL = Table
