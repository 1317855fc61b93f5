"""Lines of numbers in CSV files, as configurations read them."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from pydantic_core import PydanticCustomError

COUNTS = ("no", "one", "two", "three", "four", "five")


class NumberLine(NamedTuple):
    """The numbers of a line, and where they stand, in words."""

    place: str
    numbers: tuple[float, ...]


class NumberFile:
    """A CSV file with so many numbers in each line.

    The first line may hold names instead; empty lines and those that begin with # are skipped.

    Parameters
    ----------
    name
        Its path; ``~`` is the home folder.
    count
        Numbers in a line, five at most.
    allowed
        What the file must hold, for messages.
    """

    def __init__(self, name: str, count: int, allowed: str) -> None:
        self._path, self._count, self._allowed = Path(name).expanduser(), count, allowed

    def lines(self) -> Iterator[NumberLine]:
        """Lines of numbers from the first to the last.

        Raises
        ------
        PydanticCustomError
            If the file cannot be read, or a line holds anything else.
        """
        named = False
        for line, cells in enumerate(csv.reader(self._text().splitlines()), start=1):
            if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
                continue
            values = [_number(cell) for cell in cells]
            numbers = tuple(value for value in values if value is not None)
            if not named and len(values) == self._count and not numbers:
                named = True
                continue
            named, place = True, f"line {line}, {','.join(cells)!r},"
            if not len(numbers) == len(values) == self._count:
                raise self.refused(f"{place} is not {COUNTS[self._count]} finite numbers")
            yield NumberLine(place, numbers)

    def refused(self, problem: str, allowed: str | None = None) -> PydanticCustomError:
        """What is wrong with the file, with what it must hold."""
        return PydanticCustomError(
            "number_file",
            "file {path}: {problem}; {allowed}",
            {"path": str(self._path), "problem": problem, "allowed": allowed or self._allowed},
        )

    def _text(self) -> str:
        try:
            return self._path.read_text(encoding="utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
            problem = f"cannot be read: {reason}"
            raise self.refused(problem, "give the path of a CSV file") from error


def _number(cell: str) -> float | None:
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
