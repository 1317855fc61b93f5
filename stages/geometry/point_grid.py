"""Grids of points in CSV files."""

from __future__ import annotations

import csv
import math
from pathlib import Path

from pydantic_core import PydanticCustomError

Point = tuple[float, float, float]

ALLOWED = (
    "each line holds the numbers row, column, x, y, z of a point, separated by commas, x, y and z in mm, "
    "with rows and columns counted from 0 or 1 without gaps; the first line may hold names, and lines that "
    "begin with # are skipped"
)


def read_points(name: str) -> tuple[tuple[Point, ...], ...]:
    """Points of each row, from lines in any order.

    Raises
    ------
    PydanticCustomError
        If the file cannot be read, a line is not a point, or the points do not fill a grid.
    """
    path = Path(name).expanduser()
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        raise _refused(path, f"cannot be read: {reason}", "give the path of a CSV file") from error
    points: dict[tuple[int, int], Point] = {}
    named = False
    for line, cells in enumerate(csv.reader(text.splitlines()), start=1):
        if not any(cell.strip() for cell in cells) or cells[0].lstrip().startswith("#"):
            continue
        values = [_number(cell) for cell in cells]
        if not points and not named and len(cells) == 5 and values == [None] * 5:
            named = True
            continue
        place = f"line {line}, {','.join(cells)!r},"
        numbers = [value for value in values if value is not None]
        if len(values) != 5 or len(numbers) != 5:
            raise _refused(path, f"{place} is not five finite numbers")
        row, column, x, y, z = numbers
        if row != int(row) or column != int(column) or min(row, column) < 0:
            raise _refused(path, f"{place} does not begin with a row and a column, whole numbers")
        if (int(row), int(column)) in points:
            raise _refused(path, f"{place} gives row {row:g}, column {column:g} a second time")
        points[int(row), int(column)] = (x, y, z)
    return _rows(path, points)


def _rows(path: Path, points: dict[tuple[int, int], Point]) -> tuple[tuple[Point, ...], ...]:
    if not points:
        raise _refused(path, "holds no points")
    rows, columns = zip(*points, strict=True)
    for name, numbers in (("row", rows), ("column", columns)):
        if min(numbers) > 1:
            raise _refused(path, f"has no {name} 0 and no {name} 1")
    grid = []
    for row in range(min(rows), max(rows) + 1):
        for column in range(min(columns), max(columns) + 1):
            if (row, column) not in points:
                raise _refused(path, f"has no point in row {row}, column {column}")
        grid.append(tuple(points[row, j] for j in range(min(columns), max(columns) + 1)))
    return tuple(grid)


def _number(cell: str) -> float | None:
    try:
        value = float(cell)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _refused(path: Path, problem: str, allowed: str = ALLOWED) -> PydanticCustomError:
    return PydanticCustomError(
        "point_grid",
        "file {path}: {problem}; {allowed}",
        {"path": str(path), "problem": problem, "allowed": allowed},
    )
