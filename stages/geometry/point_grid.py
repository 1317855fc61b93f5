"""Grids of points in CSV files."""

from __future__ import annotations

from stages.number_lines import NumberFile

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
    file = NumberFile(name, 5, ALLOWED)
    points: dict[tuple[int, int], Point] = {}
    for place, (row, column, x, y, z) in file.lines():
        if row != int(row) or column != int(column) or min(row, column) < 0:
            raise file.refused(f"{place} does not begin with a row and a column, whole numbers")
        if (int(row), int(column)) in points:
            raise file.refused(f"{place} gives row {row:g}, column {column:g} a second time")
        points[int(row), int(column)] = (x, y, z)
    return _rows(file, points)


def _rows(file: NumberFile, points: dict[tuple[int, int], Point]) -> tuple[tuple[Point, ...], ...]:
    if not points:
        raise file.refused("holds no points")
    rows, columns = zip(*points, strict=True)
    for name, numbers in (("row", rows), ("column", columns)):
        if min(numbers) > 1:
            raise file.refused(f"has no {name} 0 and no {name} 1")
    grid = []
    for row in range(min(rows), max(rows) + 1):
        for column in range(min(columns), max(columns) + 1):
            if (row, column) not in points:
                raise file.refused(f"has no point in row {row}, column {column}")
        grid.append(tuple(points[row, j] for j in range(min(columns), max(columns) + 1)))
    return tuple(grid)
