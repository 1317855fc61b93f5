"""Measured course over time: points of a CSV file, joined by straight lines."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator
from typing import Any, Literal

from pydantic import model_validator
from pydantic_core import PydanticCustomError

from stages.configuration import quantity, unkeyed
from stages.number_lines import NumberFile
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
        time, factor = zip(*_points(data["file"]), strict=True)
        return data | {"time": time, "factor": factor}

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


def _points(name: str) -> Iterator[tuple[float, float]]:
    """Time and factor of each point."""
    file, last, found = NumberFile(name, 2, ALLOWED), -math.inf, 0
    for place, (time, factor) in file.lines():
        if time <= last:
            raise file.refused(f"{place} goes back in time: {last:g} ms comes before it")
        yield time, factor
        last, found = time, found + 1
    if found < 2:
        raise file.refused(f"holds {found} points: at least two are needed")


MODEL = Table
