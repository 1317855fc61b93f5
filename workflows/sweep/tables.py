"""One tidy table of a sweep: a row per case, a column per swept parameter and per quantity."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

from workflows.exports.files import replacing, write_text
from workflows.sweep.results import Cell, Column, Results


def tidy(results: Results) -> list[Column]:
    """Columns: name and state of the case, parameters, quantities, warnings, error."""
    design = results.study.design
    numbers = range(len(design))
    names: list[Cell] = [design.name(i) for i in numbers]
    errors: list[Cell] = [_one_line(results.errors.get(i)) for i in numbers]
    warnings: list[Cell] = ["; ".join(results.warnings.get(i, ())) or None for i in numbers]
    return [
        Column("case", "", names),
        Column("status", "", results.statuses),
        *results.parameters(),
        *results.measured(),
        *([Column("warnings", "", warnings)] if results.warnings else []),
        *([Column("error", "", errors)] if results.errors else []),
    ]


def write_csv(columns: list[Column], path: Path) -> None:
    """Write the table with all digits; cells without a value are empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([column.heading for column in columns])
    for row in zip(*(column.cells for column in columns), strict=True):
        writer.writerow([_text(cell) for cell in row])
    write_text(path, text.getvalue())


def write_parquet(columns: list[Column], path: Path) -> bool:
    """Write the table as Parquet, where pyarrow is installed; whether it was written."""
    try:
        import pyarrow as pa
        import pyarrow.parquet
    except ImportError:
        return False
    arrays: dict[str, Any] = {}
    fields = []
    for column in columns:
        cells: list[Any] = [
            float(cell) if column.is_numeric and cell is not None else cell for cell in column.cells
        ]
        if not column.is_numeric:
            cells = [None if cell is None else _text(cell) for cell in cells]
        kind = pa.float64() if column.is_numeric else pa.string()
        arrays[column.heading] = pa.array(cells, kind)
        about = {"unit": column.unit, "meaning": column.meaning}
        fields.append(pa.field(column.heading, kind, metadata=about))
    table = pa.Table.from_arrays(list(arrays.values()), schema=pa.schema(fields))
    with replacing(path) as temporary:
        pyarrow.parquet.write_table(table, temporary)
    return True


def _one_line(text: str | None) -> str | None:
    return None if text is None else "; ".join(text.splitlines())


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return "true" if cell else "false"
    return repr(cell) if isinstance(cell, float) else str(cell)
